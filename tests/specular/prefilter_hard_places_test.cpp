// Promise: the bounds hold where they are hardest: suns at poles and on horizons, and cubemaps of few texels.
#include <glm/geometric.hpp>

#include "specular/prefilter_support.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/specular.h"

namespace welkin::test {
namespace {

TestLatLong sun_at(int column, int row, float sun, float sky) {
  TestLatLong image = make_lat_long(Content::uniform, 256, 128, 0);
  for (float& channel : image.pixels) channel = sky;
  for (int c = 0; c < 3; ++c) image.pixels[static_cast<std::size_t>(3 * (row * 256 + column) + c)] = sun;
  return image;
}

/// Every texel of every mip against the truth.
template <class View>
LevelError worst_level(const View& view, const PrefilterOptions& options) {
  const PrefilteredSpecular result = prefilter_specular(view, options);
  LevelError worst;
  for (std::size_t level = 0; level < result.mips.size(); ++level) {
    const auto truth = reference_specular(view, result.mips[level].roughness, centres(result.mips[level].size));
    const LevelError error = level_error(result.cubemap, static_cast<int>(level), truth);
    worst.rms = std::max(worst.rms, error.rms);
    worst.maximum = std::max(worst.maximum, error.maximum);
  }
  return worst;
}

}  // namespace

TEST_CASE("A bright texel that the horizon cuts counts by its part above", "[specular][prefilter][truth]") {
  // Seen from the ring around it, the sun gives as much as the sky though hardly anything of it is above.
  for (const auto& [column, row] : {std::pair{32, 63}, {32, 38}}) {
    CAPTURE(column, row);
    const TestLatLong source = sun_at(column, row, 1e5F, 0.2F);
    const LevelError worst = worst_level(source.view(), {.size = 8, .roughness = {0.7, 1.0}});
    CHECK(worst.rms < 1e-3);
    CHECK(worst.maximum < 1e-2);
  }
}

TEST_CASE("A bright texel at a pole lies where its area is", "[specular][prefilter][truth]") {
  for (const int row : {0, 127}) {
    CAPTURE(row);
    const TestLatLong source = sun_at(3, row, 1e6F, 0.2F);
    const LevelError worst = worst_level(source.view(), {.size = 4, .roughness = {0.3, 0.7}});
    CHECK(worst.rms < 2e-4);
    CHECK(worst.maximum < 1e-2);
  }
}

TEST_CASE("Cubemaps of few texels are blurred as areas", "[specular][prefilter][truth]") {
  for (const int size : {1, 3, 7}) {
    CAPTURE(size);
    const TestCubemap source = make_cubemap(Content::random, size, 3, 5);
    const LevelError worst = worst_level(source.view(), {.size = 4, .roughness = {0.1, 0.3, 1.0}});
    CHECK(worst.rms < 1e-3);
    CHECK(worst.maximum < 1e-2);
  }
}

TEST_CASE("Values at the end of the floats do not end at infinity", "[specular][prefilter]") {
  TestLatLong source = make_lat_long(Content::random, 64, 32, 3);
  TestLatLong huge = source;
  for (float& value : huge.pixels) value *= 0x1p126F;
  huge.pixels[3 * 100] = 3.4e38F;
  source.pixels[3 * 100] = 3.4e38F * 0x1p-126F;
  const PrefilterOptions options{.size = 16, .roughness = {0.0, 0.1, 0.5, 1.0}};
  const PrefilteredSpecular plain = prefilter_specular(source.view(), options);
  const PrefilteredSpecular result = prefilter_specular(huge.view(), options);
  for (int level = 0; level < 4; ++level) {
    const auto x = level_of(plain.cubemap, level);
    const auto y = level_of(result.cubemap, level);
    for (std::size_t k = 0; k < x.size(); ++k) REQUIRE(y[k] == x[k] * 0x1p126F);
  }
  CHECK(result.pixels.flux == plain.pixels.flux * 0x1p126);
}

TEST_CASE("The darkest floats lose no digits that floats have", "[specular][prefilter]") {
  TestLatLong source = make_lat_long(Content::random, 64, 32, 3);
  TestLatLong dark = source;
  for (float& value : dark.pixels) value = std::ldexp(value, -115);
  const PrefilterOptions options{.size = 16, .roughness = {0.0, 0.02, 0.3, 1.0}, .samples = 32};
  const PrefilteredSpecular plain = prefilter_specular(source.view(), options);
  const PrefilteredSpecular result = prefilter_specular(dark.view(), options);
  for (int level = 0; level < 4; ++level) {
    const auto x = level_of(plain.cubemap, level);
    const auto y = level_of(result.cubemap, level);
    for (std::size_t k = 0; k < x.size(); ++k) REQUIRE(y[k] == std::ldexp(x[k], -115));
  }
  CHECK(result.pixels.flux == plain.pixels.flux * 0x1p-115);
}

TEST_CASE("The flux that is reported is the picture's", "[specular][prefilter]") {
  const TestLatLong source = sun_at(32, 38, 1e4F, 0.2F);
  const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 64});
  const double sun = 1e4 * image::lat_long_texel_solid_angle(256, 128, 38);
  const double sky = 0.2F * (4.0 * 3.14159265358979323846 - image::lat_long_texel_solid_angle(256, 128, 38));
  CHECK(std::abs(result.pixels.flux.x / (sun + sky) - 1.0) < 1e-5);
}

}  // namespace welkin::test
