// `welkin sky --sweep`: a picture and a text beside it; days are bright and blue, dusk is red, nights are dark.
#include <sstream>

#include "tools/baked_folder.h"
#include "tools/sky_command.h"
#include "tools/temporary_folder.h"
#include "welkin/environment_file.h"

using namespace welkin;
using namespace welkin::test;

namespace {

/// Colours of any size; the wavelengths are few, for speed.
const std::string kFewColours = kSmallSky + "--wavelengths 440,490,550,600,640,680 ";

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;
};

Picture read_picture(const std::filesystem::path& path) {
  ReadOptions options;
  options.layout = Layout::lat_long;
  const Environment environment = read_environment(path, options);
  Picture picture{environment.info.width, environment.info.height, {}};
  const auto count = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) * 3;
  const auto view = environment.lat_long();
  const auto* const pixels = static_cast<const float*>(view.pixels);
  if (view.format == PixelFormat::rgb_f32) picture.rgb.assign(pixels, pixels + count);
  return picture;
}

std::vector<double> elevations(const std::string& text) {
  std::vector<double> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::size_t number = 0;
    double elevation = 0.0;
    if (words >> number >> elevation && number == found.size() + 1) found.push_back(elevation);
  }
  return found;
}

}  // namespace

TEST_CASE("sky --sweep: picture and text have the tiles that were asked for", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "day.png";
  struct Case {
    const char* arguments;
    int width, height;
    std::size_t tiles;
    double first, last;
  };
  for (const Case& each : {Case{"--sweep-tiles 6 --sweep-size 32", 4 * 64 - 4, 2 * 36 - 4, 6, 90.0, -18.0},
                           Case{"--sweep-tiles 1 --sweep-size 16 --sun-elevation 50", 30, 16, 1, 50.0, 50.0},
                           Case{"--sweep-tiles 9 --sweep-size 15 --sweep-view fisheye --sun-elevation 61.5 --sweep-to "
                                "-7",
                                8 * 19 - 4, 2 * 19 - 4, 9, 61.5, -7.0}}) {
    INFO(each.arguments);
    const CommandResult result = run_welkin("sky " + kFewColours + each.arguments + " --sweep " + quoted(file));
    INFO(result.errors);
    REQUIRE(result.exit_code == 0);
    CHECK(result.errors.empty());
    CHECK(result.output == file_text(folder.path() / "day.txt"));
    const Picture picture = read_picture(file);
    CHECK(picture.width == each.width);
    CHECK(picture.height == each.height);
    const std::vector<double> found = elevations(result.output);
    REQUIRE(found.size() == each.tiles);
    CHECK(found.front() == each.first);
    CHECK(found.back() == each.last);
    CHECK(std::is_sorted(found.rbegin(), found.rend()));
    CHECK(names_in(folder.path()) == std::vector<std::string>{"day.png", "day.txt"});
  }
}

TEST_CASE("sky --sweep: noon is blue above, the setting sun red below, night dark", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "day.png";
  constexpr int kSize = 64;
  const CommandResult result =
      run_welkin("sky " + kFewColours + "--sweep-tiles 3 --sun-elevation 40 --sweep-to -40 --sweep-size 64 --sweep " +
                 quoted(file));
  REQUIRE(result.exit_code == 0);
  REQUIRE(elevations(result.output) == std::vector<double>{40.0, 0.0, -40.0});
  const Picture picture = read_picture(file);
  REQUIRE(picture.rgb.size() == static_cast<std::size_t>(picture.width) * kSize * 3);
  const auto at = [&](int tile, double x, double elevation) {
    const auto column = static_cast<std::size_t>(tile * 124 + x * 120);
    const auto row = static_cast<std::size_t>((90.0 - elevation) / 96.0 * kSize);
    const float* const rgb = &picture.rgb[(row * static_cast<std::size_t>(picture.width) + column) * 3];
    return glm::vec3(rgb[0], rgb[1], rgb[2]);
  };
  const glm::vec3 noon = at(0, 0.05, 60.0);
  CHECK(noon.b > 1.3F * noon.r);
  const glm::vec3 dusk = at(1, 0.5, 3.0);
  CHECK(dusk.r > 1.3F * dusk.b);
  CHECK(noon.g > 0.02F);
  const glm::vec3 night = at(2, 0.5, 30.0);
  CHECK(night.g < 0.1F * noon.g);
}

TEST_CASE("sky --sweep: a place that cannot be written to is named", "[tools][sky]") {
  CHECK(contains(sky_failure(kFewColours + "--sweep-tiles 1 --sweep-size 8 --sweep /proc/day.png", 1), "day.png"));
}
