// Seeded coefficients, directions and rotations for property tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <random>
#include <vector>

#include "welkin/spherical_harmonics.h"

namespace welkin::test {

/// Returns the coefficients of a uniform environment.
inline SphericalHarmonics constant_radiance(const glm::dvec3& radiance, int bands = 1) {
  SphericalHarmonics harmonics(bands);
  harmonics.at(0, 0) = radiance * std::sqrt(4.0 * std::numbers::pi);
  return harmonics;
}

/// Returns all 48 signed permutations of the axes.
inline std::vector<glm::dmat3> cube_symmetries() {
  std::vector<glm::dmat3> all;
  int order[3] = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 map(0.0);
      for (int k = 0; k < 3; ++k) map[k][order[k]] = (signs >> k & 1) != 0 ? -1.0 : 1.0;
      all.push_back(map);
    }
  } while (std::next_permutation(order, order + 3));
  return all;
}

class RandomLight {
 public:
  explicit RandomLight(std::uint32_t seed) : engine_(seed) {}

  /// Returns a number in [-1, 1).
  double number() { return static_cast<double>(engine_()) * 0x1p-31 - 1.0; }

  glm::dvec3 colour() {
    const double r = number();
    const double g = number();
    return {r, g, number()};
  }

  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 d = colour();
      const double length = glm::length(d);
      if (length > 0.1 && length < 1.0) return d / length;
    }
  }

  /// Returns a unit quaternion; all rotations are equally likely.
  glm::dquat rotation() {
    for (;;) {
      const glm::dvec3 v = colour();
      const glm::dquat q(number(), v.x, v.y, v.z);
      if (glm::length(q) > 0.1 && glm::length(q) < 1.0) return glm::normalize(q);
    }
  }

  SphericalHarmonics harmonics(int bands) {
    SphericalHarmonics result(bands);
    for (glm::dvec3& value : result.coefficients()) value = colour();
    return result;
  }

 private:
  std::mt19937 engine_;
};

/// Returns the coefficients of light of irradiance `colour` from one direction.
inline SphericalHarmonics point_light(const glm::dvec3& direction, const glm::dvec3& colour, int bands) {
  SphericalHarmonics result(bands);
  std::vector<double> basis(result.coefficients().size());
  evaluate_basis(direction, bands, basis);
  for (std::size_t k = 0; k < basis.size(); ++k) result.coefficients()[k] = basis[k] * colour;
  return result;
}

}  // namespace welkin::test
