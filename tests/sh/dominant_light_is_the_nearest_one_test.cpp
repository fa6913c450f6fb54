// Promise: of a constant and a directional light the dominant light is that directional light; it turns with the light.
#include <algorithm>
#include <limits>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "welkin/directional_light.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::test {

TEST_CASE("A directional light over a constant comes back", "[sh][dominant]") {
  RandomLight light(61);
  for (const int bands : {2, 3, 4, 16}) {
    for (const double strength : {1e-30, 1e-3, 1.0, 222208.0, 1e30}) {
      const glm::dvec3 direction = light.direction();
      const glm::dvec3 irradiance = strength * glm::dvec3(1.0, 0.7, 0.2);
      // Ambient light ten times as strong is no hindrance: band 0 is not looked at.
      const SphericalHarmonics radiance =
          add(constant_radiance(strength * glm::dvec3(10, 20, 30), bands), point_light(direction, irradiance, bands));
      const auto found = dominant_light(radiance);
      CAPTURE(bands, strength);
      REQUIRE(found);
      CHECK(glm::length(found->direction - direction) < 1e-14);
      CHECK(glm::length(found->irradiance - irradiance) < 1e-13 * glm::length(irradiance));
    }
  }
}

TEST_CASE("No directional light comes closer to bands 1 and 2", "[sh][dominant]") {
  RandomLight light(62);
  const SphericalHarmonics radiance =
      add(point_light(light.direction(), {3, 2, 1}, 3), scale(light.harmonics(3), glm::dvec3(0.2)));
  const auto found = dominant_light(radiance);
  REQUIRE(found);
  const auto distance = [&](const glm::dvec3& irradiance) {
    SphericalHarmonics rest = add(radiance, scale(point_light(found->direction, irradiance, 3), glm::dvec3(-1.0)));
    rest.at(0, 0) = glm::dvec3(0.0);
    return norm(rest);
  };
  const double least = distance(found->irradiance);
  for (int c = 0; c < 3; ++c) {
    for (const double step : {-1e-3, 1e-3}) {
      glm::dvec3 other = found->irradiance;
      other[c] += step;
      CHECK(distance(other) > least);
    }
  }
}

TEST_CASE("The dominant light turns with its environment", "[sh][dominant]") {
  RandomLight light(63);
  for (int k = 0; k < 20; ++k) {
    const SphericalHarmonics radiance = add(light.harmonics(4), constant_radiance({5, 5, 5}, 4));
    const glm::dquat turn = light.turn();
    const auto before = dominant_light(radiance);
    const auto after = dominant_light(rotate(radiance, turn));
    REQUIRE(before);
    REQUIRE(after);
    CHECK(glm::length(after->direction - turn * before->direction) < 1e-13);
    CHECK(glm::length(after->irradiance - before->irradiance) < 1e-13);
    for (int c = 0; c < 3; ++c) CHECK(before->irradiance[c] >= 0.0);
  }
}

TEST_CASE("Light without a direction has no dominant light", "[sh][dominant]") {
  CHECK_FALSE(dominant_light(SphericalHarmonics(3)));
  CHECK_FALSE(dominant_light(constant_radiance({1, 2, 3}, 3)));
  CHECK_FALSE(dominant_light(constant_radiance({1, 2, 3}, 1)));
  // What a projection's rounding leaves of a uniform sky.
  CHECK_FALSE(dominant_light(add(constant_radiance({1, 1, 1}, 3), point_light({0, 1, 0}, glm::dvec3(1e-7), 3))));
  SphericalHarmonics broken = point_light({0, 1, 0}, {1, 1, 1}, 3);
  broken.at(1, 0).r = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(dominant_light(broken));
  // Two equal lights face to face cancel in the linear band.
  CHECK_FALSE(dominant_light(add(point_light({0, 1, 0}, {1, 1, 1}, 3), point_light({0, -1, 0}, {1, 1, 1}, 3))));
}

TEST_CASE("A colour that comes from behind is not taken below zero", "[sh][dominant]") {
  const auto found = dominant_light(add(point_light({0, 1, 0}, {0, 5, 0}, 3), point_light({0, -1, 0}, {0, 0, 1}, 2)));
  REQUIRE(found);
  CHECK(found->irradiance.b == 0.0);
  CHECK(found->irradiance.g > 0.0);
}

}  // namespace welkin::test
