
#include "tools/baked_folder.h"
#include "tools/command.h"
#include "tools/sky_command.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/sky.h"

using namespace welkin;
using namespace welkin::test;

// `welkin sky -o DIR`: the bundle is that of `welkin bake` of the image that lies beside it.

namespace {

const std::string kSmallBake = "--irradiance 16 --brdf 16 ";

nlohmann::json bake_sky(const std::filesystem::path& folder, const std::string& arguments) {
  printed_by("sky " + kSmallSky + kSmallBake + arguments + " -o " + quoted(folder));
  return manifest_of(folder);
}

}  // namespace

TEST_CASE("sky -o: the files are those of a bake of sky.exr", "[tools][sky][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto sky = scratch.path() / "sky";
  const auto baked = scratch.path() / "baked";
  for (const std::string& engine : {std::string(), std::string("--for unreal ")}) {
    const nlohmann::json manifest =
        bake_sky(sky, engine + "--sun-elevation 20 --image-height 64 --no-previews --formats ktx2,dds,exr,env");
    CHECK(names_in(sky) == names_of(manifest));
    bake_into(baked, engine + kSmallBake + "--size 32 --background-size 128 --no-previews --formats ktx2,dds,exr,env " +
                         quoted(sky / "sky.exr"));
    std::vector<std::string> names = names_in(baked);
    names.insert(std::upper_bound(names.begin(), names.end(), "sky.exr"), "sky.exr");
    REQUIRE(names_in(sky) == names);
    for (const std::string& name : names_in(baked)) {
      if (name == "manifest.json" || name == "sh.json" || name == "sh.h") continue;  // they name their source
      INFO(name);
      CHECK((file_text(sky / name) == file_text(baked / name)));
    }
    const auto ours = json_of(file_text(sky / "sh.json"));
    const auto theirs = json_of(file_text(baked / "sh.json"));
    CHECK(ours.at("radiance") == theirs.at("radiance"));
    CHECK(ours.at("engines") == theirs.at("engines"));
  }
}

TEST_CASE("sky -o: sky.exr is the library's image, the sun left out unless asked for", "[tools][sky][bake][slow]") {
  const TemporaryFile out("out");
  const auto tables = small_sky();
  const SkyView view(tables, 0.0);
  const glm::dvec3 sun = sun_direction(30.0, 40.0);
  for (const bool inside : {false, true}) {
    const nlohmann::json manifest =
        bake_sky(out, std::string("--sun-elevation 30 --sun-azimuth 40 --image-height 48 --no-previews ") +
                          (inside ? "--sun-disc" : ""));
    const Environment stored = read_environment(out / "sky.exr");
    const LatLongImage expected = sky_lat_long(view, sun, 48, {.sun_disc = inside});
    REQUIRE(stored.info.width == 96);
    const auto* pixels = static_cast<const float*>(stored.lat_long().pixels);
    CHECK(std::equal(expected.pixels.begin(), expected.pixels.end(), pixels));
    CHECK(manifest.contains("sun") == !inside);
    CHECK(manifest.at("sky").at("sun_elevation_degrees") == 30.0);
    if (!inside) {
      CHECK(rgb_of(manifest.at("sun").at("irradiance")) == view.sun_light(sun).irradiance);
      CHECK(rgb_of(manifest.at("sun").at("direction")) == view.sun_light(sun).direction);
    }
    const auto sh = json_of(file_text(out / "sh.json"));
    CHECK(sh.contains("sun") == !inside);
  }
}

// `welkin sky --sweep`: an image and a text beside it; days are bright and blue, dusk is red, nights are dark.

namespace {

/// Colours of any size; the wavelengths are few, for speed.
const std::string kFewColours = kSmallSky + "--wavelengths 440,490,550,600,640,680 ";

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

TEST_CASE("sky --sweep: image and text have the tiles that were asked for", "[tools][sky][slow]") {
  const TemporaryDirectory folder;
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
    const std::string said = printed_by("sky " + kFewColours + each.arguments + " --sweep " + quoted(file));
    CHECK(said == file_text(folder.path() / "day.txt"));
    const EnvironmentInfo image = read_environment(file, {.layout = Layout::lat_long}).info;
    CHECK(image.width == each.width);
    CHECK(image.height == each.height);
    const std::vector<double> found = elevations(said);
    REQUIRE(found.size() == each.tiles);
    CHECK(found.front() == each.first);
    CHECK(found.back() == each.last);
    CHECK(std::is_sorted(found.rbegin(), found.rend()));
    CHECK(names_in(folder.path()) == std::vector<std::string>{"day.png", "day.txt"});
  }
}

// `welkin sky` writes air as JSON and reads it; what is wrong with a file is said with its name.

namespace {

nlohmann::json printed(const std::string& arguments) { return json_printed_by("sky --print-atmosphere " + arguments); }

void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

nlohmann::json same_light(const nlohmann::json& document) {
  return {document.at("radiance"), document.at("sun"), document.at("sky").at("parameters")};
}

}  // namespace

TEST_CASE("sky: air that was printed is read as the same air", "[tools][sky][slow]") {
  const TemporaryFile file("air.json");
  for (const char* preset : {"earth", "dusty", "earth-bruneton", "earth-hillaire", "mars", "no-aerosol"}) {
    INFO(preset);
    write(file, printed(std::string("--preset ") + preset).dump());
    CHECK(same_light(sky_json("--atmosphere " + quoted(file))) ==
          same_light(sky_json(std::string("--preset ") + preset)));
  }
  const nlohmann::json air = printed("--ground-albedo 0.3 --wavelengths 615,535,445");
  CHECK(air.at("ground_albedo") == nlohmann::json({0.3, 0.3, 0.3}));
  CHECK(air.at("wavelengths_nm") == nlohmann::json({615.0, 535.0, 445.0}));
  CHECK(air.at("solar_irradiance").get<std::vector<double>>() == earth({615.0, 535.0, 445.0}).solar_irradiance);
  CHECK(printed("--colour srgb").at("wavelengths_nm").size() == 15);
}

TEST_CASE("sky: files that hold no air are refused", "[tools][sky][posix]") {
  const TemporaryDirectory folder;
  const auto file = folder.path() / "air.json";
  const auto refused = [&](const std::string& text, const std::string& message) {
    write(file, text);
    const std::string said = sky_failure("--atmosphere " + quoted(file), 1);
    INFO(said);
    CHECK(contains(said, "air.json: "));
    CHECK(contains(said, message));
  };
  refused("", "is not JSON");
  refused("{\"name\": ", "is not JSON");
  refused("{\"bottom_radius_m\": NaN}", "is not JSON");
  refused("{\"bottom_radius_m\": 1e999}", "");
  refused("[]", "not a JSON object");
  refused("\xff\xfe", "is not JSON");
  refused(std::string(100000, '['), "nested too deeply");
  refused("{\"ground_albedo\": [" + std::string(20000, '0') + "]}", "");
  refused(
      "{\"ground_albedo\": [0" +
          [] {
            std::string text;
            for (int i = 0; i < 5000; ++i) text += ",0";
            return text;
          }() +
          "]}",
      "5001 elements");
  refused(std::string(2 << 20, ' '), "megabyte");
  CHECK(contains(sky_failure("--atmosphere " + quoted(folder.path() / "none.json"), 1), "none.json"));
  CHECK(contains(sky_failure("--atmosphere " + quoted(folder.path()), 1), "directory"));
  CHECK(contains(sky_failure("--atmosphere a.json --preset mars", 2), "--preset"));
}
