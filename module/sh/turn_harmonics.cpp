// Rotations and mirrors of coefficients.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "sh/band_rotation.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"

namespace welkin {
namespace {

constexpr double kOrthogonalWithin = 1e-6;

SphericalHarmonics turned(const SphericalHarmonics& harmonics, const glm::dmat3& map) {
  SphericalHarmonics result(harmonics.bands());
  result.at(0, 0) = harmonics.at(0, 0);
  sh::BandRotation matrix(map);
  for (int l = 1; l < harmonics.bands(); ++l) {
    matrix.advance();
    for (int m = -l; m <= l; ++m) {
      glm::dvec3 sum(0.0);
      for (int n = -l; n <= l; ++n) sum += matrix.at(m, n) * harmonics.at(l, n);
      result.at(l, m) = sum;
    }
  }
  return result;
}

/// Of unit length. Divided by the largest component first: no square overflows or vanishes.
glm::dquat normalised(const glm::dquat& q) {
  const double largest = std::max({std::abs(q.w), std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  const double sum = std::abs(q.w) + std::abs(q.x) + std::abs(q.y) + std::abs(q.z);  // NaN if any of them is
  if (!(largest > 0.0) || !std::isfinite(largest) || std::isnan(sum)) {
    throw Error(ErrorCode::invalid_argument, "the quaternion (w x y z) = (" + std::to_string(q.w) + " " +
                                                 std::to_string(q.x) + " " + std::to_string(q.y) + " " +
                                                 std::to_string(q.z) +
                                                 ") has no length that could be made 1; (1 0 0 0) turns nothing");
  }
  const double w = q.w / largest;
  const double x = q.x / largest;
  const double y = q.y / largest;
  const double z = q.z / largest;
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  return {w / length, x / length, y / length, z / length};
}

/// Largest entry of |M^T M - 1|; NaN if M has one.
double distance_from_orthogonal(const glm::dmat3& matrix) {
  double distance = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double off = std::abs(glm::dot(matrix[i], matrix[j]) - (i == j ? 1.0 : 0.0));
      if (!(off <= distance)) distance = off;
      if (std::isnan(off)) return off;
    }
  }
  return distance;
}

}  // namespace

SphericalHarmonics rotate(const SphericalHarmonics& harmonics, const glm::dquat& rotation) {
  return turned(harmonics, glm::mat3_cast(normalised(rotation)));
}

SphericalHarmonics transform(const SphericalHarmonics& harmonics, const glm::dmat3& orthogonal) {
  const double off = distance_from_orthogonal(orthogonal);
  if (!(off <= kOrthogonalWithin)) {
    throw Error(ErrorCode::invalid_argument,
                "the matrix is not orthogonal: its columns' products are off those of unit axes by up to " +
                    std::to_string(off) + " (1e-6 is allowed); scaling and shearing are no turns of light");
  }
  // What is off would grow with the band. M (3 - M^T M) / 2 squares the distance from the nearest orthogonal matrix
  // (Bjorck and Bowie 1971); twice is enough from 1e-6, and an exact matrix stays as it is.
  glm::dmat3 map = orthogonal;
  for (int step = 0; step < 2; ++step) map = 0.5 * (map * (glm::dmat3(3.0) - glm::transpose(map) * map));
  return turned(harmonics, map);
}

}  // namespace welkin
