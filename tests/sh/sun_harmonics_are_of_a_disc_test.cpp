// Promise: a sun's coefficients are those of a uniform disc of its solid angle, from a point to the whole sphere.
#include <cmath>
#include <limits>
#include <numbers>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/thrown_error.h"
#include "tables/gauss_legendre.h"
#include "welkin/directional_light.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::test {
namespace {

constexpr double kPi = std::numbers::pi;

Sun sun_of(const glm::dvec3& direction, double solid_angle) {
  Sun sun;
  sun.direction = direction;
  sun.radiance = {3.0, 2.0, 1.0};
  sun.solid_angle = solid_angle;
  sun.irradiance = solid_angle * sun.radiance;
  return sun;
}

/// Coefficients of a cap around z: Gauss' rule over its height, exact for the Legendre polynomials.
SphericalHarmonics integrated_cap(double solid_angle, int bands) {
  SphericalHarmonics sum(bands);
  const simd::GaussRule rule = tables::gauss_legendre(bands);
  std::vector<double> basis(sum.coefficients().size());
  for (int i = 0; i < rule.order; ++i) {
    const double away = solid_angle / (2.0 * kPi) * 0.5 * (1.0 + rule.nodes[i]);  // 1 - z
    evaluate_basis({std::sqrt(away * (2.0 - away)), 0.0, 1.0 - away}, bands, basis);
    for (int l = 0; l < bands; ++l) {
      sum.at(l, 0) +=
          glm::dvec3(3, 2, 1) * (basis[SphericalHarmonics::index(l, 0)] * rule.weights[i] * 0.5 * solid_angle);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("A disc's coefficients are its integral, from tiny to all around", "[sh][sun]") {
  for (const double solid_angle : {1e-12, 6.8e-5, 0.01, 1.0, 2.0 * kPi, 9.0, 4.0 * kPi}) {
    const SphericalHarmonics found = sun_harmonics(sun_of({0, 0, 1}, solid_angle), kMaximumBands);
    CAPTURE(solid_angle);
    CHECK(relative_error(found, integrated_cap(solid_angle, kMaximumBands)) < 1e-13);
    RandomLight light(71);
    const glm::dvec3 direction = light.direction();
    const glm::dvec3 half = glm::normalize(glm::dvec3(0, 0, 1) + direction);  // half a turn about it takes z there
    const glm::dquat turn(0.0, half.x, half.y, half.z);
    CHECK(relative_error(sun_harmonics(sun_of(direction, solid_angle), kMaximumBands), rotate(found, turn)) < 1e-13);
  }
}

TEST_CASE("A sun without extent is a directional light", "[sh][sun]") {
  Sun sun = sun_of(glm::normalize(glm::dvec3(1, 2, 3)), 0.0);
  sun.irradiance = {5, 6, 7};
  CHECK(relative_error(sun_harmonics(sun, 16), point_light(sun.direction, {5, 6, 7}, 16)) < 1e-14);
  const auto found = dominant_light(sun_harmonics(sun, 3));
  REQUIRE(found);
  CHECK(glm::length(found->irradiance - sun.irradiance) < 1e-13);
}

TEST_CASE("A sun's flux is its irradiance, and what it gives to a surface facing it has a closed form", "[sh][sun]") {
  for (const double solid_angle : {6.8e-5, 0.5, 3.0}) {
    const Sun sun = sun_of({0, 1, 0}, solid_angle);
    const SphericalHarmonics radiance = sun_harmonics(sun, 16);
    CHECK(glm::length(4.0 * kPi * average_radiance(radiance) - sun.irradiance) < 1e-13 * glm::length(sun.irradiance));
    // Int of cos over a disc: pi sin^2 a L = irradiance (1 + cos a) / 2; 16 bands give it to one percent.
    const double c = 1.0 - solid_angle / (2.0 * kPi);
    const glm::dvec3 facing = evaluate(irradiance_from_radiance(radiance), sun.direction);
    CHECK(facing.x == Approx(sun.irradiance.x * 0.5 * (1.0 + c)).epsilon(0.01));
  }
}

TEST_CASE("A sphere full of sun is uniform light", "[sh][sun]") {
  const SphericalHarmonics all = sun_harmonics(sun_of({1, 0, 0}, 4.0 * kPi), 8);
  CHECK(relative_error(all, constant_radiance({3, 2, 1}, 8)) < 1e-14);
}

TEST_CASE("Suns that cannot be are refused", "[sh][sun]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double solid_angle : {-1e-9, 12.6, nan}) {
    CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, 1, 0}, solid_angle), 3); }).says("solid angle"));
  }
  CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, 0, 0}, 0.1), 3); }).says("direction"));
  CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, nan, 0}, 0.1), 3); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, 1, 0}, 0.1), 17); }).says("1 to 16"));
}

}  // namespace welkin::test
