// Suns in a lat-long's polar rows: their direction is that of their light, not of texels' centres.
#include "support/catch.h"
#include "support/sun_maps.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

/// The mean direction of a texel, by a plain sum over its area.
glm::dvec3 centroid_of(int width, int height, int row, int column) {
  constexpr int cells = 64;
  glm::dvec3 sum(0.0);
  for (int j = 0; j < cells; ++j) {
    const double polar = std::numbers::pi * (row + (j + 0.5) / cells) / height;
    for (int i = 0; i < cells; ++i) {
      const double longitude = std::numbers::pi * (1.0 - 2.0 * (column + (i + 0.5) / cells) / width);
      sum += std::sin(polar) *
             glm::dvec3(std::sin(polar) * std::sin(longitude), std::cos(polar), std::sin(polar) * std::cos(longitude));
    }
  }
  return glm::normalize(sum);
}

/// The rest and the sun, in harmonics, against the map before: the largest difference over the largest coefficient.
double loss(const LatLongImage& before, const LatLongImage& after, const Sun& sun, int bands) {
  const SphericalHarmonics whole = project(before.view(), {.bands = bands}).radiance;
  const SphericalHarmonics parts = add(project(after.view(), {.bands = bands}).radiance, sun_harmonics(sun, bands));
  double most = 0.0;
  for (std::size_t k = 0; k < whole.coefficients().size(); ++k) {
    most = std::max(most, std::abs(whole.coefficients()[k].g - parts.coefficients()[k].g));
  }
  return most / std::abs(whole.at(0, 0).g);
}

}  // namespace

TEST_CASE("A lamp of one texel beside the pole has the direction of the texel's light", "[image][sun]") {
  for (const int width : {128, 256, 512, 1024}) {
    for (const int row : {0, 1, 5, width / 2 - 1}) {
      CAPTURE(width, row);
      LatLongImage image = grey_lat_long(width, width / 2, 0.01F);
      const int column = width / 3;
      const auto texel = static_cast<std::size_t>(3 * (row * width + column));
      for (std::size_t c = 0; c < 3; ++c) image.pixels[texel + c] = 1e6F;
      LatLongImage rest = image;
      const auto sun = extract_sun(rest);
      REQUIRE(sun);
      CHECK(degrees_between(sun->direction, centroid_of(width, width / 2, row, column)) < 1e-3);
    }
  }
}

TEST_CASE("A sun beside the pole and the rest of its map make the map's harmonics again", "[image][sun][truth]") {
  for (const double off : {0.3, 2.0}) {
    const double angle = off * std::numbers::pi / 180.0;
    const glm::dvec3 place(std::sin(angle) * 0.6, std::cos(angle), std::sin(angle) * 0.8);
    LatLongImage image = grey_lat_long(512, 256, 1.0F);
    paint_disc(image, place, 0.265, glm::dvec3(2e5, 1.5e5, 5e4));
    LatLongImage rest = image;
    const auto sun = extract_sun(rest);
    REQUIRE(sun);
    CAPTURE(off);
    CHECK(loss(image, rest, *sun, 3) < 5e-5);
    CHECK(loss(image, rest, *sun, 8) < 1e-3);
  }
}

}  // namespace welkin::test
