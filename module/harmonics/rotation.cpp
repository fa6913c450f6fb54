// Rotations and mirrors of coefficients.
#include "harmonics/rotation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

constexpr double kOrthogonalWithin = 1e-6;

SphericalHarmonics turned_by(const glm::dmat3& map, const SphericalHarmonics& harmonics) {
  SphericalHarmonics result(harmonics.bands());
  result.at(0, 0) = harmonics.at(0, 0);
  harmonics::BandRotation matrix(map);
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
glm::dquat normalised(const Quaternion& q) {
  const double largest = std::max({std::abs(q.w), std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  const double sum = std::abs(q.w) + std::abs(q.x) + std::abs(q.y) + std::abs(q.z);  // NaN if any of them is
  if (!(largest > 0.0) || !std::isfinite(largest) || std::isnan(sum)) {
    throw Error(ErrorCode::invalid_argument, "the quaternion (w x y z) = (" + platform::number_text(q.w) + " " +
                                                 platform::number_text(q.x) + " " + platform::number_text(q.y) + " " +
                                                 platform::number_text(q.z) +
                                                 ") cannot be normalized; (1 0 0 0) is the identity");
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

SphericalHarmonics turned(const SphericalHarmonics& harmonics, const Quaternion& turn) {
  const platform::FloatingPointScope floating_point;
  return turned_by(glm::mat3_cast(normalised(turn)), harmonics);
}

SphericalHarmonics turned(const SphericalHarmonics& harmonics, const dmat3& turn) {
  const platform::FloatingPointScope floating_point;
  const double off = distance_from_orthogonal(turn);
  if (!(off <= kOrthogonalWithin)) {
    throw Error(ErrorCode::invalid_argument,
                "the matrix is not orthogonal: its columns' products are off those of unit axes by up to " +
                    platform::number_text(off) +
                    " (1e-6 is allowed); pass a rotation or mirror without scale and shear");
  }
  // What is off would grow with the band. M (3 - M^T M) / 2 squares the distance from the nearest orthogonal matrix
  // (Bjorck and Bowie 1971); twice is enough from 1e-6, and an exact matrix stays as it is.
  glm::dmat3 map = turn;
  for (int step = 0; step < 2; ++step) map = 0.5 * (map * (glm::dmat3(3.0) - glm::transpose(map) * map));
  return turned_by(map, harmonics);
}

}  // namespace welkin

namespace welkin::harmonics {

// J. Ivanic and K. Ruedenberg, "Rotation Matrices for Real Spherical Harmonics. Direct Determination by Recursion",
// J. Phys. Chem. 100, 1996, 6342-6347, with the corrections in J. Phys. Chem. A 102, 1998, 9099-9100.
//
// A harmonic of band l is the band-l part of products of harmonics of bands 1 and l - 1. The map acts on the factors,
// so the matrix of band l is a sum of products of entries of the two matrices. The sums' coefficients u, v, w come from
// the Legendre functions' recurrences and depend on (l, m, n) only.

BandRotation::BandRotation(const glm::dmat3& map) {
  constexpr int axis[3] = {1, 2, 0};  // Y(1, -1..1) ~ y, z, x
  for (int m = 0; m < 3; ++m) {
    for (int n = 0; n < 3; ++n) linear_[m][n] = map[axis[n]][axis[m]];  // GLM: column, then row
  }
}

void BandRotation::advance() {
  std::swap(before_, here_);
  ++band_;
  const int l = band_;
  here_.resize(static_cast<std::size_t>((2 * l + 1) * (2 * l + 1)));
  for (int m = -l; m <= l; ++m) {
    for (int n = -l; n <= l; ++n) here_[index(l, m, n)] = l == 1 ? linear(m, n) : entry(m, n);
  }
}

// The paper's P (table 2): row i of band 1 times row m of band l - 1, the part that belongs to column n of band l.
double BandRotation::product(int i, int m, int n) const noexcept {
  const int l = band_;
  if (n == l) return linear(i, 1) * before(m, l - 1) - linear(i, -1) * before(m, 1 - l);
  if (n == -l) return linear(i, 1) * before(m, 1 - l) + linear(i, -1) * before(m, l - 1);
  return linear(i, 0) * before(m, n);
}

// u U + v V + w W (tables 1 and 2). Where a factor is zero its product would reach outside band l - 1 and is left out.
double BandRotation::entry(int m, int n) const noexcept {
  const int l = band_;
  const int size = std::abs(m);
  const double below = std::abs(n) == l ? 2.0 * l * (2.0 * l - 1.0) : (l + n) * (static_cast<double>(l) - n);
  double sum = 0.0;
  if (size < l) sum += std::sqrt((l + m) * (static_cast<double>(l) - m) / below) * product(0, m, n);

  const double v = 0.5 * std::sqrt((l + size - 1.0) * (l + size) / below);
  const double root2 = std::sqrt(2.0);
  if (m == 0) {
    sum -= v * root2 * (product(1, 1, n) + product(-1, -1, n));
  } else if (m == 1) {
    sum += v * root2 * product(1, 0, n);
  } else if (m == -1) {
    sum += v * root2 * product(-1, 0, n);
  } else if (m > 0) {
    sum += v * (product(1, m - 1, n) - product(-1, 1 - m, n));
  } else {
    sum += v * (product(1, m + 1, n) + product(-1, -m - 1, n));
  }

  if (m == 0 || size > l - 2) return sum;
  const double w = 0.5 * std::sqrt((l - size - 1.0) * (l - size) / below);
  if (m > 0) return sum - w * (product(1, m + 1, n) + product(-1, -m - 1, n));
  return sum - w * (product(1, m - 1, n) - product(-1, 1 - m, n));
}

}  // namespace welkin::harmonics
