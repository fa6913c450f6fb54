// Promises: the coefficients of a map are those of the map without its sun plus those of a directional light of its
// irradiance, but for what the sun's extent explains.
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "support/catch.h"
#include "support/sun_maps.h"
#include "welkin/directional_light.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

constexpr int kBands = 6;

template <class Image>
void check_coefficients(Image image, const glm::dvec3& place, double radius) {
  paint_disc(image, glm::normalize(place), radius, {2e5, 1.5e5, 5e4});
  ProjectionOptions options;
  options.bands = kBands;
  const SphericalHarmonics before = project(image.view(), options).radiance;
  const auto sun = take_out_sun(image);
  REQUIRE(sun);
  const SphericalHarmonics after = project(image.view(), options).radiance;
  std::vector<double> basis(kBands * kBands);
  evaluate_basis(sun->direction, kBands, basis);
  // A uniform disc of radius r has 1 - l(l+1) r^2 / 8 of a directional light's band l; the largest that a vector of
  // one band's functions can be is sqrt((2l + 1) / 4 pi).
  const double r = sun->angular_radius_degrees * std::numbers::pi / 180.0;
  for (int l = 0; l < kBands; ++l) {
    double difference = 0.0;
    for (int m = -l; m <= l; ++m) {
      const std::size_t i = SphericalHarmonics::index(l, m);
      const double missing = after.at(l, m).g + sun->irradiance.g * basis[i] - before.at(l, m).g;
      difference += missing * missing;
    }
    const double light = sun->irradiance.g * std::sqrt((2 * l + 1) / (4.0 * std::numbers::pi));
    CAPTURE(l, radius, std::sqrt(difference) / light);
    CHECK(std::sqrt(difference) < (1.1 * l * (l + 1) * r * r / 8.0 + 1e-6) * light);
    if (l == 2) CHECK(std::sqrt(difference) > 0.3 * l * (l + 1) * r * r / 8.0 * light);
  }
}

}  // namespace

TEST_CASE("A map's coefficients are those without the sun and those of its light", "[image][sun]") {
  for (const glm::dvec3& place : {glm::dvec3(1, 1, 1), glm::dvec3(0, 1, 0), glm::dvec3(-3, 2, 4)}) {
    for (const double radius : {0.8, 1.6, 2.4}) {
      check_coefficients(grey_lat_long(512, 256, 1.0F), place, radius);
      check_coefficients(grey_cubemap(128, 1.0F), place, radius);
    }
  }
}

}  // namespace welkin::test
