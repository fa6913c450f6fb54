// J. Ivanic and K. Ruedenberg, "Rotation Matrices for Real Spherical Harmonics. Direct Determination by Recursion",
// J. Phys. Chem. 100, 1996, 6342-6347, with the corrections in J. Phys. Chem. A 102, 1998, 9099-9100.
//
// A harmonic of band l is the band-l part of products of harmonics of bands 1 and l - 1. The map acts on the factors,
// so the matrix of band l is a sum of products of entries of the two matrices. The sums' coefficients u, v, w come from
// the Legendre functions' recurrences and depend on (l, m, n) only.
#include "sh/band_rotation.h"

#include <cmath>
#include <cstdlib>
#include <utility>

namespace welkin::sh {

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

}  // namespace welkin::sh
