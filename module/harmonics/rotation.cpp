// Rotations and mirrors of coefficients.
#include "harmonics/rotation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

constexpr double kOrthogonalWithin = 1e-6;

SphericalHarmonics rotate_by(const glm::dmat3& map, const SphericalHarmonics& harmonics) {
  SphericalHarmonics result = harmonics;
  if (harmonics.bands() < 2) return result;
  const glm::dvec3 x = harmonics.at(1, 1);
  const glm::dvec3 y = harmonics.at(1, -1);
  const glm::dvec3 z = harmonics.at(1, 0);
  // Band 1 is b . d with b = (c(1, 1), c(1, -1), c(1, 0)), up to one factor: f(M^-1 d) = b . (M^T d) = (M b) . d for
  // orthogonal M.
  const auto row = [&](int axis) { return map[0][axis] * x + map[1][axis] * y + map[2][axis] * z; };
  result.at(1, 1) = row(0);
  result.at(1, -1) = row(1);
  result.at(1, 0) = row(2);
  if (harmonics.bands() > 2) harmonics::ThreeRotations(map, harmonics.bands()).apply(result);
  return result;
}

/// Returns the quaternion at unit length. Divides by the largest component first: no square overflows or vanishes.
glm::dquat normalized(const Quaternion& q) {
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

SphericalHarmonics rotate(const SphericalHarmonics& harmonics, const Quaternion& rotation) {
  const platform::FloatingPointScope floating_point;
  return rotate_by(glm::mat3_cast(normalized(rotation)), harmonics);
}

SphericalHarmonics rotate(const SphericalHarmonics& harmonics, const dmat3& rotation) {
  const platform::FloatingPointScope floating_point;
  const double off = distance_from_orthogonal(rotation);
  if (!(off <= kOrthogonalWithin)) {
    throw Error(ErrorCode::invalid_argument,
                "the matrix is not orthogonal: its columns' products are off those of unit axes by up to " +
                    platform::number_text(off) +
                    " (1e-6 is allowed); pass a rotation or mirror without scale and shear");
  }
  // Deviations would increase with the band. M (3 - M^T M) / 2 squares the distance from the nearest orthogonal matrix
  // (Bjorck and Bowie 1971); twice is enough from 1e-6, and an exact matrix stays as it is.
  glm::dmat3 map = rotation;
  // For M^T M = 1 + D the next one's is (1 + D) (1 - D / 2)^2 = 1 - 3/4 D^2 + D^3 / 4: 1e-6 becomes 8e-13 and then
  // 4e-25.
  for (int step = 0; step < 2; ++step) map = 0.5 * (map * (glm::dmat3(3.0) - glm::transpose(map) * map));
  return rotate_by(map, harmonics);
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
  matrices_[0][0] = 1.0;
}

void BandRotation::advance() {
  ++band_;
  const int l = band_;
  Matrix& here = matrices_[l % 2];
  for (int m = -l; m <= l; ++m) {
    for (int n = -l; n <= l; ++n) here[index(l, m, n)] = l == 1 ? linear(m, n) : entry(m, n);
  }
}

// The paper's P (table 2): row i of band 1 times row m of band l - 1, the part that belongs to column n of band l.
double BandRotation::product(int i, int m, int n) const noexcept {
  const int l = band_;
  if (n == l) return linear(i, 1) * before(m, l - 1) - linear(i, -1) * before(m, 1 - l);
  if (n == -l) return linear(i, 1) * before(m, 1 - l) + linear(i, -1) * before(m, l - 1);
  return linear(i, 0) * before(m, n);
}

namespace {

/// u, v and w of the papers' table 1, |m| in place of m.
struct Factors {
  double u, v, w;
};

Factors factors(int l, int m, int n) noexcept {
  const int size = std::abs(m);
  const double below = std::abs(n) == l ? 2.0 * l * (2.0 * l - 1.0) : (l + n) * (static_cast<double>(l) - n);
  return {std::sqrt((l + m) * (static_cast<double>(l) - m) / below),
          0.5 * std::sqrt((l + size - 1.0) * (l + size) / below),
          0.5 * std::sqrt((l - size - 1.0) * (l - size) / below)};
}

}  // namespace

// u U + v V + w W (tables 1 and 2). Where a factor is zero its product would reach outside band l - 1 and is left out.
double BandRotation::entry(int m, int n) const noexcept {
  const int l = band_;
  const int size = std::abs(m);
  const auto [u, v, w] = factors(l, m, n);
  double sum = 0.0;
  if (size < l) sum += u * product(0, m, n);

  const double root2 = std::numbers::sqrt2;
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
  if (m > 0) return sum - w * (product(1, m + 1, n) + product(-1, -m - 1, n));
  return sum - w * (product(1, m - 1, n) - product(-1, 1 - m, n));
}

namespace {

/// The matrices of the mirror that swaps y and z, one per band. Harmonics are even or odd in each axis, so row m has a
/// quarter of the columns: every other one on one side of 0.
class Swap {
 public:
  explicit Swap(int bands) : first_(static_cast<std::size_t>(bands)) {
    BandRotation matrix({{1, 0, 0}, {0, 0, 1}, {0, 1, 0}});
    for (int l = 1; l < bands; ++l) {
      matrix.advance();
      first_[static_cast<std::size_t>(l)] = entries_.size();
      for (int m = -l; m <= l; ++m) {
        for (int n = begin(l, m); n <= end(l, m); n += 2) entries_.push_back(matrix.at(m, n));
      }
    }
  }

  /// to[m] of band l = the mirror of from[m]; both are counted from the middle.
  void apply(int l, const glm::dvec3* from, glm::dvec3* to) const {
    const double* entry = entries_.data() + first_[static_cast<std::size_t>(l)];
    for (int m = -l; m <= l; ++m) {
      glm::dvec3 sum(0.0);
      for (int n = begin(l, m); n <= end(l, m); n += 2) sum += *entry++ * from[n];
      to[m] = sum;
    }
  }

  /// That of at least so many bands; made by the first call.
  static const Swap& of_bands(int bands) {
    constexpr int few = 4;
    if (bands <= few) {
      static const Swap kept(few);
      return kept;
    }
    static const Swap kept(kMaximumBands);
    return kept;
  }

 private:
  // Y(l, m) is even in y for m >= 0, else odd, and even in z for even l + m.
  // The swap exchanges the parities in y and z: Y(l, n) meets Y(l, m) only if n >= 0 (even in y) goes with even l + m
  // (even in z), and even l + n with m >= 0. So even l + m takes n from 0 to l, odd l + m n from -l to -1, and in both
  // cases l + n has the parity of m's side, in steps of 2.
  static int begin(int l, int m) {
    const int parity = m >= 0 ? 0 : 1;  // of l + n
    if ((l + m) % 2 == 0) return (l + parity) % 2;
    return -l + parity;
  }
  static int end(int l, int m) { return (l + m) % 2 == 0 ? l : -1; }

  std::vector<std::size_t> first_;
  std::vector<double> entries_;
};

/// Coefficients of a band after a turn about z: of Y(l, m) and Y(l, -m), which hold the cosine and the sine of m phi.
void rotate_about_z(int l, const glm::dvec2* turns, glm::dvec3* middle) {
  for (int m = 1; m <= l; ++m) {
    // Rotated by a:
    //   c cos(m (phi - a)) + s sin(m (phi - a))
    //     = (c cos(m a) - s sin(m a)) cos(m phi) + (c sin(m a) + s cos(m a)) sin(m phi).
    const glm::dvec3 cosine = middle[m];
    const glm::dvec3 sine = middle[-m];
    middle[m] = turns[m].x * cosine - turns[m].y * sine;
    middle[-m] = turns[m].y * cosine + turns[m].x * sine;
  }
}

}  // namespace

// The third column of Rz(alpha) Ry(beta) Rz(gamma) is (cos alpha sin beta, sin alpha sin beta, cos beta); the second
// row of Rz(-alpha) times it is (sin gamma, cos gamma, 0). Near the poles alpha is off, and gamma by as much in the
// other direction, so that the product is not.
ThreeRotations::ThreeRotations(const glm::dmat3& map, int bands)
    : mirrored_(glm::determinant(map) < 0.0), bands_(bands) {
  const double sign = mirrored_ ? -1.0 : 1.0;
  constexpr double least = 1e-20;
  // `row(k)` is (-sin alpha, cos alpha, 0) . column k, the second row of Rz(-alpha) M: (sin gamma, cos gamma, 0).
  const glm::dvec3 pole = sign * map[2];
  const double sine = std::sqrt(pole.x * pole.x + pole.y * pole.y);
  const glm::dvec2 alpha = sine > least ? glm::dvec2(pole.x / sine, pole.y / sine) : glm::dvec2(1.0, 0.0);
  const auto row = [&](int column) { return sign * (alpha.x * map[column].y - alpha.y * map[column].x); };
  set_multiples({row(1), row(0)}, turns_[0]);
  set_multiples({pole.z, sine > least ? -sine : 0.0}, turns_[1]);  // y and z are swapped: the other way round
  set_multiples(alpha, turns_[2]);
}

void ThreeRotations::set_multiples(const glm::dvec2& rotation, Multiples& multiples) const {
  multiples[0] = {1.0, 0.0};
  for (int m = 1; m < bands_; ++m) {
    // e^(i m a) = e^(i (m - 1) a) e^(i a).
    const glm::dvec2 before = multiples[static_cast<std::size_t>(m - 1)];
    multiples[static_cast<std::size_t>(m)] = {before.x * rotation.x - before.y * rotation.y,
                                              before.y * rotation.x + before.x * rotation.y};
  }
}

void ThreeRotations::apply(SphericalHarmonics& harmonics) const {
  const Swap& swap = Swap::of_bands(bands_);
  glm::dvec3 swapped[2 * kMaximumBands - 1];
  for (int l = 2; l < bands_; ++l) {
    glm::dvec3* const middle = &harmonics.at(l, 0);
    glm::dvec3* const mirror = swapped + l;
    rotate_about_z(l, turns_[0].data(), middle);
    swap.apply(l, middle, mirror);
    rotate_about_z(l, turns_[1].data(), mirror);
    swap.apply(l, mirror, middle);
    rotate_about_z(l, turns_[2].data(), middle);
    // An inversion d -> -d multiplies band l by (-1)^l; a mirror is a rotation after it.
    if (!mirrored_ || l % 2 == 0) continue;
    for (int m = -l; m <= l; ++m) middle[m] = -middle[m];
  }
}

}  // namespace welkin::harmonics
