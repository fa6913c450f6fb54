#include <array>
#include <cmath>

#include "tools/baked_folder.h"
#include "tools/command.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

using namespace welkin;
using namespace welkin::test;

// Promises: previews are there, of the size that the manifest says, and show the surroundings the right way round.

namespace {

/// A PNG as light.
class Preview {
 public:
  explicit Preview(const std::filesystem::path& path) {
    ReadOptions options;
    options.layout = Layout::lat_long;
    picture_ = read_environment(path, options);
  }

  [[nodiscard]] int width() const { return picture_.info.width; }
  [[nodiscard]] int height() const { return picture_.info.height; }

  /// At a place in units of `unit` pixels from the upper left.
  [[nodiscard]] std::array<float, 3> at(double x, double y, int unit = 1) const {
    const auto column = static_cast<std::size_t>(x * unit);
    const auto row = static_cast<std::size_t>(y * unit);
    const float* const rgb = picture_.pixels.get() + (row * static_cast<std::size_t>(width()) + column) * 3;
    return {rgb[0], rgb[1], rgb[2]};
  }

 private:
  Environment picture_;
};

/// Red grows along x, green along y, blue along z.
std::filesystem::path write_directions(const std::filesystem::path& folder) {
  constexpr int kWidth = 128;
  constexpr int kHeight = 64;
  std::vector<float> pixels;
  const double pi = std::acos(-1.0);
  for (int row = 0; row < kHeight; ++row) {
    const double latitude = pi / 2 - pi * (row + 0.5) / kHeight;
    for (int column = 0; column < kWidth; ++column) {
      const double longitude = pi - 2 * pi * (column + 0.5) / kWidth;
      const std::array<double, 3> direction = {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                                               std::cos(longitude) * std::cos(latitude)};
      for (const double value : direction) pixels.push_back(static_cast<float>(1.0 + value));
    }
  }
  const auto path = folder / "directions.pfm";
  write_pfm(path, kWidth, kHeight, pixels);
  return path;
}

constexpr int kCell = 256;   // of the cross
constexpr int kPitch = 144;  // of the balls

}  // namespace

TEST_CASE("bake: previews have the size that the manifest says", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto folder = scratch.path() / "out";
  for (const std::string options : {"--sky --size 64", "--sky --size 5 --irradiance 0 --no-brdf", "--sky --size 1"}) {
    const auto manifest = bake_into(folder, options);
    CHECK(manifest.at("previews").at("exposure").get<double>() > 0.0);
    for (const char* name : {"preview_environment.png", "preview_spheres.png", "preview_mips.png"}) {
      INFO(options << ' ' << name);
      const auto said = file_of(manifest, name);
      const Preview preview(folder / name);
      CHECK(said.at("width") == preview.width());
      CHECK(said.at("height") == preview.height());
    }
  }
}

TEST_CASE("bake: the cross shows what one sees who faces +z", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto in = write_directions(scratch.path());
  bake_into(scratch.path() / "out", quoted(in) + " --size 64");
  const Preview cross(scratch.path() / "out" / "preview_environment.png");
  REQUIRE(cross.width() == 4 * kCell);
  REQUIRE(cross.height() == 3 * kCell);
  const auto at = [&](double x, double y) { return cross.at(x, y, kCell); };
  CHECK(at(0.5, 1.5)[0] > 1.5F * at(2.5, 1.5)[0]);  // +x to the left, -x to the right
  CHECK(at(1.5, 0.5)[1] > 1.5F * at(1.5, 2.5)[1]);  // +y above, -y below
  CHECK(at(1.5, 1.5)[2] > 1.5F * at(3.5, 1.5)[2]);  // +z in front, -z behind
  // Inside the cells: neither mirrored nor upside down.
  CHECK(at(1.1, 1.5)[0] > 1.2F * at(1.9, 1.5)[0]);  // front
  CHECK(at(1.5, 1.1)[1] > 1.2F * at(1.5, 1.9)[1]);
  CHECK(at(0.9, 1.5)[2] > 1.2F * at(0.1, 1.5)[2]);  // left: +z lies to the right of +x
  CHECK(at(3.9, 1.5)[0] > 1.2F * at(3.1, 1.5)[0]);  // back: +x lies to the right of -z
  CHECK(at(1.5, 0.9)[2] > 1.2F * at(1.5, 0.1)[2]);  // up: +z is next to the front
  CHECK(at(1.5, 2.1)[2] > 1.2F * at(1.5, 2.9)[2]);  // down
  CHECK(at(0.5, 0.5)[1] < 0.05F);                   // nothing beside the arms
  // Without a seam where cells meet that meet on the sphere.
  for (const double x : {1.0, 2.0, 3.0}) {
    for (int c = 0; c < 3; ++c) {
      const auto channel = static_cast<std::size_t>(c);
      CHECK(std::abs(at(x - 0.004, 1.5)[channel] - at(x + 0.004, 1.5)[channel]) < 0.02F);
    }
  }
}

TEST_CASE("bake: the balls mirror what is behind the viewer, and are lit from above by the sky", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto in = write_directions(scratch.path());
  bake_into(scratch.path() / "out", quoted(in) + " --size 64");
  const Preview balls(scratch.path() / "out" / "preview_spheres.png");
  REQUIRE(balls.height() == 4 * kPitch);
  REQUIRE(balls.width() == 7 * kPitch);
  const auto at = [&](double x, double y) { return balls.at(x, y, kPitch); };
  for (int row = 0; row < 4; ++row) {
    for (int ball = 0; ball < 7; ++ball) {
      INFO("row " << row << ", ball " << ball);
      const double x = ball + 0.5;
      const double y = row + 0.5;
      CHECK(at(x + 0.25, y)[0] > 1.1F * at(x - 0.25, y)[0]);  // +x is to the right
      CHECK(at(x, y - 0.25)[1] > 1.1F * at(x, y + 0.25)[1]);  // +y is up
      CHECK(at(x, y)[2] > 1.1F * at(x + 0.43, y)[2]);         // +z is behind the viewer
    }
  }
  const auto corner = at(3.0, 0.02);  // between balls: the background, which is -z
  CHECK(corner[2] < 0.5F * at(0.5, 0.5)[2]);
}

TEST_CASE("bake: rows of balls are metals and dielectrics, as large as --preview-size says", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto in = scratch.path() / "grey.pfm";
  write_pfm(in, 16, 8, grey_picture(16, 8, 1.0F));
  constexpr int kSmallPitch = 36;  // of balls of 32 pixels
  const auto balls_of = [&](const std::string& options) {
    bake_into(scratch.path() / "out", quoted(in) + " --size 16 --preview-size 32" + options);
    return Preview(scratch.path() / "out" / "preview_spheres.png");
  };
  const Preview balls = balls_of("");
  CHECK(balls.width() == 7 * kSmallPitch);
  REQUIRE(balls.height() == 4 * kSmallPitch);
  const auto ratio = [&](int row, std::size_t channel) {  // to red, of the smoothest ball
    const auto rgb = balls.at(0.5, row + 0.5, kSmallPitch);
    return rgb[channel] / rgb[0];
  };
  CHECK(ratio(0, 2) > 0.9F);  // silver
  CHECK(ratio(1, 2) < 0.6F);  // gold
  CHECK(ratio(2, 1) < 0.5F);  // red
  CHECK(ratio(3, 2) == Approx(1.0F).margin(0.01));
  // Edges are antialiased: a row of pixels through the dark red ball's rim has values between ball and background.
  const float inside = balls.at(0.5, 2.5, kSmallPitch)[1];
  const float outside = balls.at(0.02, 2.02, kSmallPitch)[1];
  int between = 0;
  for (int column = 0; column < kSmallPitch; ++column) {
    const float green = balls.at(column, 2 * kSmallPitch + 4)[1];
    if (green > 1.2F * inside && green < 0.9F * outside) ++between;
  }
  CHECK(between >= 2);
  // Without irradiance a dielectric cannot be shown.
  CHECK(balls_of(" --irradiance 0").height() == 2 * kSmallPitch);
  CHECK(run_welkin("bake " + quoted(in) + " --preview-size 7 -o " + quoted(scratch.path() / "no")).exit_code == 2);
  CHECK_FALSE(std::filesystem::exists(scratch.path() / "no"));
}

TEST_CASE("bake: the built-in sky's sun is in the upper half", "[tools][bake]") {
  const TemporaryFolder scratch;
  bake_into(scratch.path() / "out", "--sky --size 128");
  const Preview cross(scratch.path() / "out" / "preview_environment.png");
  double weight = 0.0;
  double rows = 0.0;
  for (int row = kCell; row < 2 * kCell; ++row) {
    for (int column = 0; column < 4 * kCell; ++column) {
      const auto rgb = cross.at(column, row);
      const double light = std::pow(rgb[0] * rgb[1] * rgb[2], 4.0);
      weight += light;
      rows += light * (row - kCell);
    }
  }
  CHECK(rows / weight < 0.5 * kCell);
  const auto sky = cross.at(2.5, 1.2, kCell);
  const auto ground = cross.at(2.5, 1.9, kCell);
  CHECK(sky[2] > 1.3F * sky[0]);
  CHECK(ground[2] < 1.2F * ground[0]);
  CHECK(ground[2] < sky[2]);
}

TEST_CASE("bake: a map without light has black previews", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto in = scratch.path() / "dark.pfm";
  write_pfm(in, 8, 4, grey_picture(8, 4, 0.0F));
  bake_into(scratch.path() / "out", quoted(in) + " --size 8");
  const Preview balls(scratch.path() / "out" / "preview_spheres.png");
  for (const float value : balls.at(72, 72)) CHECK(value == 0.0F);
}

// Promise: the same input gives the same files, bit for bit, on any number of threads and every instruction set; only
// the times in the manifest differ.

namespace {

void check_same(const std::filesystem::path& folder, const std::filesystem::path& expected) {
  REQUIRE(names_in(folder) == names_in(expected));
  for (const std::string& name : names_in(expected)) {
    INFO(name);
    if (name == "manifest.json") {
      nlohmann::json ours = manifest_of(folder);
      nlohmann::json theirs = manifest_of(expected);
      for (nlohmann::json* manifest : {&ours, &theirs}) {
        for (auto& pass : manifest->at("times")) pass.erase("ms");
      }
      CHECK(ours == theirs);
    } else {
      CHECK((file_text(folder / name) == file_text(expected / name)));
    }
  }
}

const std::string kOptions = "--sky --size 64 --irradiance 16 --brdf 16 --formats ktx2,dds,exr,env ";

}  // namespace

TEST_CASE("bake: the same files on any number of threads", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto expected = scratch.path() / "one";
  bake_into(expected, kOptions + "--threads 1");
  for (const char* threads : {"--threads 2", "--threads 5", ""}) {
    INFO(threads);
    bake_into(scratch.path() / "many", kOptions + threads);
    check_same(scratch.path() / "many", expected);
  }
}

TEST_CASE("bake: the same files on every instruction set", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto expected = scratch.path() / "expected";
  bake_into(expected, kOptions);
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name(set));
    bake_into(scratch.path() / "set", kOptions, std::string("WELKIN_ISA=") + name(set));
    check_same(scratch.path() / "set", expected);
  }
}
