// Promise: the minimum over the sphere is the global one, to rounding, at the direction that is named.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sh/harmonic_derivatives.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "tables/trigonometry.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/windowing.h"

namespace welkin::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The least of a dense grid: above the true minimum by about (bands / points)^2.
glm::dvec3 least_of_dense_grid(const SphericalHarmonics& harmonics, int rings) {
  glm::dvec3 least(std::numeric_limits<double>::infinity());
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = kPi * ring / rings;
    for (int k = 0; k < 2 * rings; ++k) {
      const double azimuth = kPi * k / rings;
      least = glm::min(least, evaluate(harmonics, {std::sin(polar) * std::cos(azimuth),
                                                   std::sin(polar) * std::sin(azimuth), std::cos(polar)}));
    }
  }
  return least;
}

}  // namespace

TEST_CASE("No point of a dense grid is lower than the minimum, and one is nearly as low", "[sh][minimum]") {
  RandomLight light(31);
  for (const int bands : {1, 2, 3, 4, 5, 8, 16}) {
    for (int k = 0; k < (bands > 5 ? 2 : 10); ++k) {
      const SphericalHarmonics harmonics = light.harmonics(bands);
      const HarmonicMinimum found = minimum(harmonics);
      const int rings = 20 * bands;
      const glm::dvec3 least = least_of_dense_grid(harmonics, rings);
      CAPTURE(bands, k);
      for (int c = 0; c < 3; ++c) {
        CHECK(found.value[c] <= least[c] + 1e-12);
        CHECK(found.value[c] >= least[c] - 0.01 * norm(harmonics));
        CHECK(std::abs(evaluate(harmonics, found.direction[c])[c] - found.value[c]) < 1e-12 * norm(harmonics));
        CHECK(glm::length(found.direction[c]) == Approx(1.0).epsilon(1e-14));
      }
    }
  }
}

TEST_CASE("The minimum turns with the light and does not change", "[sh][minimum]") {
  RandomLight light(32);
  for (const int bands : {2, 3, 5, 16}) {
    const SphericalHarmonics harmonics = light.harmonics(bands);
    const HarmonicMinimum before = minimum(harmonics);
    for (int k = 0; k < 5; ++k) {
      const glm::dquat turn = light.turn();
      const HarmonicMinimum after = minimum(rotate(harmonics, turn));
      for (int c = 0; c < 3; ++c) {
        CHECK(std::abs(after.value[c] - before.value[c]) < 1e-12);
        CHECK(glm::length(after.direction[c] - turn * before.direction[c]) < 1e-6);
      }
    }
  }
}

TEST_CASE("Minima known in closed form are found, on rings and at poles too", "[sh][minimum]") {
  RandomLight light(33);
  for (int k = 0; k < 20; ++k) {
    const glm::dquat turn = k == 0 ? glm::dquat(1, 0, 0, 0) : light.turn();
    SphericalHarmonics linear(2);
    linear.at(1, 0) = {1.0, -2.0, 0.0};
    linear = rotate(linear, turn);
    const double y1 = std::sqrt(3.0 / (4.0 * kPi));
    CHECK(glm::length(minimum(linear).value - glm::dvec3(-y1, -2.0 * y1, 0.0)) < 1e-14);

    SphericalHarmonics zonal(3);  // sqrt(5 / 16 pi) (3 z^2 - 1): a ring of minima, or two poles if negative
    zonal.at(2, 0) = {1.0, -1.0, 1e-30};
    zonal = rotate(zonal, turn);
    const double y2 = std::sqrt(5.0 / (16.0 * kPi));
    const glm::dvec3 found = minimum(zonal).value;
    CHECK(std::abs(found.x + y2) < 1e-14);
    CHECK(std::abs(found.y + 2.0 * y2) < 1e-14);
  }
}

TEST_CASE("Of several valleys that run around the sphere, level or nearly so, the lowest place is found",
          "[sh][minimum]") {
  RandomLight light(41);
  for (const int bands : {3, 5, 8, 12}) {
    for (int k = 0; k < 40; ++k) {
      SphericalHarmonics zonal(bands);
      for (int l = 0; l < bands; ++l) zonal.at(l, 0) = (k % 2 == 0 || l % 2 == 0 ? 1.0 : 1e-4) * light.colour();
      if (k % 4 >= 2) {
        for (int l = 1; l < bands; ++l) zonal.at(l, 1) = 1e-5 * light.colour();
      }
      const HarmonicMinimum found = minimum(zonal);
      const int steps = 500;
      glm::dvec3 least(std::numeric_limits<double>::infinity());
      for (int i = -steps; i <= steps; ++i) {
        const double polar = kPi * i / steps;
        least = glm::min(least, evaluate(zonal, {std::sin(polar), 0.0, std::cos(polar)}));
      }
      CAPTURE(bands, k);
      for (int c = 0; c < 3; ++c) CHECK(found.value[c] <= least[c] + 1e-12);
    }
  }
}

TEST_CASE("Light of any size, none and no number have their minima", "[sh][minimum]") {
  RandomLight light(34);
  const SphericalHarmonics harmonics = light.harmonics(3);
  const HarmonicMinimum found = minimum(harmonics);
  for (const double size : {0x1p100, 0x1p-100, 0x1p900, 0x1p-900}) {
    const HarmonicMinimum scaled = minimum(scale(harmonics, glm::dvec3(size)));
    for (int c = 0; c < 3; ++c) CHECK(scaled.value[c] == Approx(found.value[c] * size).epsilon(1e-13));
  }
  CHECK(minimum(SphericalHarmonics(16)).value == glm::dvec3(0.0));
  const glm::dvec3 constant = minimum(constant_radiance({1, -2, 0}, 16)).value;
  CHECK(glm::length(constant - glm::dvec3(1, -2, 0)) < 1e-14);
  SphericalHarmonics broken = harmonics;
  broken.at(2, 1).g = std::numeric_limits<double>::quiet_NaN();
  broken.at(2, 1).b = -std::numeric_limits<double>::infinity();
  CHECK(minimum(broken).value.r == found.value.r);
  CHECK(std::isnan(minimum(broken).value.g));
  CHECK(std::isnan(minimum(broken).value.b));
}

TEST_CASE("Slopes and curvatures agree with differences", "[sh][minimum]") {
  RandomLight light(35);
  for (const int bands : {1, 2, 3, 8, 16}) {
    std::vector<double> channel(static_cast<std::size_t>(bands * bands));
    for (double& value : channel) value = light.number();
    const glm::dvec3 d = light.direction();
    const auto at = [&](const glm::dvec3& p) { return sh::harmonic_derivatives(channel, bands, p); };
    const sh::HarmonicDerivatives here = at(d);
    const double step = 1e-5;
    const double size = std::pow(bands, 4.0);  // third derivatives grow so
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 along(0.0);
      along[i] = step;
      const sh::HarmonicDerivatives ahead = at(d + along);
      const sh::HarmonicDerivatives behind = at(d - along);
      CAPTURE(bands, i);
      CHECK(std::abs((ahead.value - behind.value) / (2.0 * step) - here.gradient[i]) < 1e-8 * size);
      CHECK(glm::length((ahead.gradient - behind.gradient) / (2.0 * step) - here.hessian[i]) < 1e-7 * size);
    }
  }
}

}  // namespace welkin::test
