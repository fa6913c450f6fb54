#include <algorithm>
#include <limits>
#include <vector>

#include "support/catch.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

LatLongImage halves(float upper, float lower) {
  LatLongImage picture{64, 32, std::vector<float>(std::size_t{3} * 64 * 32, upper)};
  std::fill(picture.pixels.begin() + 3 * 64 * 16, picture.pixels.end(), lower);
  return picture;
}

}  // namespace

TEST_CASE("exposure of harmonics takes the mean to middle grey", "[exposure]") {
  CHECK(exposure_of(constant_radiance(dvec3(9.0), 3)) == Approx(0.02).epsilon(1e-14));
  CHECK(exposure_of(constant_radiance(dvec3(0.0, 1.0, 0.0), 1)) == Approx(0.18 / 0.7152).epsilon(1e-14));
  CHECK(exposure_of(constant_radiance(dvec3(0.0), 3)) == 1.0);
  CHECK(exposure_of(constant_radiance(dvec3(-1.0), 3)) == 1.0);
  CHECK(exposure_of(constant_radiance(dvec3(1e-310), 3)) == 1.0);
  CHECK(exposure_of(constant_radiance(dvec3(std::numeric_limits<double>::quiet_NaN()), 3)) == 1.0);
}

TEST_CASE("exposure of a picture takes three quarters of what is lit to 0.36", "[exposure]") {
  CHECK(exposure_of(halves(5.0F, 5.0F).view()) == Approx(0.36 / 5.0));
  CHECK(exposure_of(halves(8.0F, 2.0F).view()) == Approx(0.36 / 8.0));
  CHECK(exposure_of(halves(8.0F, 0.0F).view()) == Approx(0.36 / 8.0));  // black is not lit
  CHECK(exposure_of(halves(0.0F, 0.0F).view()) == 1.0);
  LatLongImage sunny = halves(8.0F, 8.0F);
  sunny.pixels[3 * 64 * 10] = 1e9F;  // a sun moves nothing
  sunny.pixels[3 * 64 * 20] = std::numeric_limits<float>::quiet_NaN();
  CHECK(exposure_of(sunny.view()) == Approx(0.36 / 8.0));
}

TEST_CASE("exposure weighs texels by solid angle, of cubes as of lat-longs, in every format", "[exposure]") {
  // The top third of the rows is 0.25 of the sphere: just the brightest quarter.
  LatLongImage picture = halves(1.0F, 1.0F);
  std::fill_n(picture.pixels.begin(), 3 * 64 * 10, 3.0F);
  CHECK(exposure_of(picture.view()) == Approx(0.36));
  std::fill_n(picture.pixels.begin(), 3 * 64 * 11, 3.0F);
  CHECK(exposure_of(picture.view()) == Approx(0.12));
  std::fill_n(picture.pixels.begin(), 3 * 64 * 13, 3.0F);  // no mixed texel of the cube is in question
  CHECK(exposure_of(to_cubemap(picture.view(), 32).view()) == Approx(0.12).epsilon(1e-5));
  const std::vector<std::uint8_t> bytes(std::size_t{4} * 8 * 4, 255);
  CHECK(exposure_of(LatLongView{bytes.data(), 8, 4, 0, PixelFormat::rgba8}) == Approx(0.36));
  CHECK_THROWS_AS(exposure_of(LatLongView{}), Error);
}

}  // namespace welkin::test
