// Promises: every picture of OpenEXR's own reader tests that is at hand is read as OpenEXR reads it, or refused with a
// clear word.
#include <algorithm>
#include <cmath>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/shared_pictures.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

const std::filesystem::path kConformance = test::kPictures / "exr_conformance";

std::filesystem::path picture(const std::string& name) { return kConformance / ("openexr_" + name + ".exr"); }

// None of them is an environment; any ratio can be taken for a lat-long.
Environment read(const std::string& name, Primaries primaries = Primaries::rec709) {
  ReadOptions options;
  options.layout = Layout::lat_long;
  options.primaries = primaries;
  return read_environment(picture(name), options);
}

bool equal(const Environment& found, const std::vector<float>& wanted) {
  return static_cast<std::size_t>(3 * found.info.width * found.info.height) == wanted.size() &&
         std::equal(wanted.begin(), wanted.end(), found.pixels.get(),
                    [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); });
}

// By how many halves' roundings (2^-11 of the texel's brightest channel) two pictures differ at the worst texel.
double worst_in_halves(const Environment& found, const Environment& wanted) {
  REQUIRE(found.info.width == wanted.info.width);
  REQUIRE(found.info.height == wanted.info.height);
  double worst = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(3 * found.info.width * found.info.height); i += 3) {
    const float* a = found.pixels.get() + i;
    const float* b = wanted.pixels.get() + i;
    const double scale = std::max({std::abs(b[0]), std::abs(b[1]), std::abs(b[2]), 1e-3F}) / 2048.0;
    for (int channel = 0; channel < 3; ++channel) {
      worst = std::max(worst, std::abs(a[channel] - b[channel]) / scale);
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("plain pictures are what the library reads", "[codec][shared]") {
  if (!test::shared_pictures_are_here()) {
    return;
  }
  for (const char* name : {"BrightRings", "BrightRingsNanInf", "Rec709", "ColorCodedLevels"}) {
    CAPTURE(name);
    CHECK(equal(read(name), test::read_exr_with_library(picture(name))));
  }
  for (const char* name : {"Rec709_YC", "XYZ_YC", "Garden", "XYZ"}) {
    CAPTURE(name);
    CHECK(equal(read(name, Primaries::as_stored), test::read_rgba_with_library(picture(name))));
  }
}

TEST_CASE("X, Y, Z become the Rec. 709 that they were made from", "[codec][shared]") {
  if (!test::shared_pictures_are_here()) {
    return;
  }
  CHECK(worst_in_halves(read("XYZ"), read("Rec709")) < 6.0);
  CHECK(read("XYZ").info.notes == std::vector<std::string>{"primaries converted from CIE XYZ to Rec. 709"});
}

TEST_CASE("all levels of the colour-coded mip map have its colours", "[codec][shared]") {
  if (!test::shared_pictures_are_here()) {
    return;
  }
  ReadOptions options;
  options.layout = Layout::lat_long;
  REQUIRE(inspect_environment(picture("ColorCodedLevels"), options).levels.size() == 10);
  std::vector<float> firsts;
  for (; options.level < 10; ++options.level) {
    const Environment level = read_environment(picture("ColorCodedLevels"), options);
    CHECK(level.info.width == 512 >> options.level);
    firsts.push_back(level.pixels[0] + 10.0F * level.pixels[1] + 100.0F * level.pixels[2]);
  }
  std::sort(firsts.begin(), firsts.end());
  CHECK(std::unique(firsts.begin(), firsts.end()) - firsts.begin() >= 5);
}

TEST_CASE("each view of the stereo picture in parts is read", "[codec][shared]") {
  if (!test::shared_pictures_are_here()) {
    return;
  }
  ReadOptions options;
  options.layout = Layout::lat_long;
  const EnvironmentInfo info = inspect_environment(picture("multipart.0001"), options);
  CHECK(info.parts.size() == 10);
  CHECK(info.width == 877);
  const Environment right = read_environment(picture("multipart.0001"), options);
  options.part = "rgba_left";
  const Environment left = read_environment(picture("multipart.0001"), options);
  CHECK_FALSE(std::equal(right.pixels.get(), right.pixels.get() + 877 * 876 * 3, left.pixels.get()));
  CHECK(measure_environment(picture("multipart.0001"), options).maximum.x > 0.0);
  options.part = "depth_left";
  CHECK(test::thrown_by([&] {
          (void)inspect_environment(picture("multipart.0001"), options);
        }).says("has channels Z; R, G and B, or Y alone or with RY and BY, are read"));
}

TEST_CASE("what is no environment says why", "[codec][shared]") {
  if (!test::shared_pictures_are_here()) {
    return;
  }
  CHECK(test::thrown_by([] {
          (void)inspect_environment(picture("WideFloatRange"));
        }).says("has channels G; R, G and B, or Y alone or with RY and BY, are read: rename or convert"));
  for (const char* name : {"Rec709", "Garden", "XYZ_YC", "multipart.0001"}) {
    CHECK(test::thrown_by([&] { (void)inspect_environment(picture(name)); }).says("neither a 2:1 lat-long"));
  }
  CHECK(test::thrown_by([] { (void)inspect_environment(picture("BrightRings")); }).says("is square"));
}

}  // namespace welkin
