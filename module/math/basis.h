// The loop that gives real spherical harmonics as polynomials of the direction, for one number or a
// register of them at a time.
//
// With r = 1, orthonormal and without Condon-Shortley phase,
//
//   Y(l, m)  = q(l, m)(z) C_m,  Y(l, -m) = q(l, m)(z) S_m,  m >= 0,     C_m + i S_m = (x + i y)^m.
//
// The azimuth's cos(m phi) sin^m(theta) and sin(m phi) sin^m(theta) are C_m and S_m: two multiply-adds each
// from m - 1, no trigonometry, and nothing to divide by at the poles. What is left of the associated Legendre
// function, q(l, m) = N(l, m) P_l^m(z) / sin^m(theta), is a polynomial of degree l - m in z, with
// N^2 = (2 - [m = 0]) (2l + 1) / (4 pi) (l - m)! / (l + m)!.
//
// Start of a column:  q(m, m) = N(m, m) (2m - 1)!!, hence
//   q(0, 0)^2 = 1 / (4 pi),   q(m, m)^2 = q(m - 1, m - 1)^2 (2m + 1) / (2m) x (2 if m = 1 else 1).
// Down a column, from (l - m) P_l^m = (2l - 1) z P_(l-1)^m - (l + m - 1) P_(l-2)^m and the ratios of N:
//   q(l, m) = a(l, m) z q(l - 1, m) - b(l, m) q(l - 2, m),   q(m - 1, m) = 0,
//   a^2 = (4 l^2 - 1) / (l^2 - m^2),   b^2 = (2l + 1) ((l - 1)^2 - m^2) / ((2l - 3) (l^2 - m^2)).
// Going up in l at fixed m is the stable way for this recurrence, and the normalized values stay of the
// size of sqrt((2l + 1) / 4 pi): no factorial appears that could overflow.
//
// Sources: P.-P. Sloan, "Efficient Spherical Harmonic Evaluation", JCGT 2(2), 2013 (the Cartesian split);
// S. A. Holmes and W. E. Featherstone, "A unified approach to the Clenshaw summation ...", Journal of
// Geodesy 76, 2002, equations 11 to 13 (the normalized recurrence).
#pragma once

#include <cstddef>
#include <vector>

#include "platform/compiler.h"

namespace welkin::math {

inline constexpr int kRecurrenceBands = 16;

/// The recurrence's constants; a and b are read at [m][l] for l > m.
struct BasisRecurrence {
  double start[kRecurrenceBands];  ///< q(m, m)
  double a[kRecurrenceBands][kRecurrenceBands];
  double b[kRecurrenceBands][kRecurrenceBands];
};

/// Calls `put(l (l + 1) + m, scale Y(l, m)(x, y, z))` for all l < bands. Number: double, or lanes of it.
/// Always inlined, so that no instruction set's copy can stand in for another's.
template <class Number, class Put>
WELKIN_INLINE void for_each_basis_value(const BasisRecurrence& recurrence, Number x, Number y, Number z, Number scale,
                                        int bands, const Put& put) {
  Number cosine = scale;  // scale C_m
  Number sine(0.0);       // scale S_m
  for (int m = 0; m < bands; ++m) {
    Number before(0.0);
    Number here(recurrence.start[m]);
    for (int l = m;;) {
      const int centre = l * (l + 1);
      put(centre + m, here * cosine);
      if (m > 0) put(centre - m, here * sine);
      if (++l == bands) break;
      const Number next = Number(recurrence.a[m][l]) * z * here - Number(recurrence.b[m][l]) * before;
      before = here;
      here = next;
    }
    const Number next_cosine = x * cosine - y * sine;
    sine = x * sine + y * cosine;
    cosine = next_cosine;
  }
}

/// Calls `use(l, P_l(x))` for l < count. (l + 1) P_(l+1) = (2 l + 1) x P_l - l P_(l-1), from P_0 = 1: stable for
/// |x| <= 1.
template <class Use>
void for_each_legendre(double x, std::size_t count, const Use& use) {
  double before = 0.0;
  double legendre = 1.0;
  for (std::size_t l = 0; l < count; ++l) {
    use(l, legendre);
    const auto degree = static_cast<double>(l);
    const double next = ((2.0 * degree + 1.0) * x * legendre - degree * before) / (degree + 1.0);
    before = legendre;
    legendre = next;
  }
}

/// The zonal function whose coefficients by degree are `factors`: the sum of (2 l + 1) / (4 pi) factors[l] P_l(x).
[[nodiscard]] double sum_of_degrees(const std::vector<double>& factors, double x) noexcept;

/// For all bands; built once.
[[nodiscard]] const BasisRecurrence& basis_constants() noexcept;

// The real spherical harmonics' values at a direction, for those who call it a million times.

/// Writes Y(l, m)(x, y, z) for all l < bands and -l <= m <= l to values[l (l + 1) + m]: bands^2 of them.
///
/// (x, y, z) is a unit direction and 1 <= bands <= kMaximumBands; neither is checked. The arithmetic is the same on
/// every machine: + - * and constants that come from + - * / and correctly rounded square roots. As polynomials of
/// x, y, z as given the values are off by less than 5e-15 up to 8 bands, 2e-14 up to 16 (largest at the poles, where
/// m = 0 peaks). About 3 flops a value, no allocation. A direction that is not of unit length gives polynomials in
/// it, not harmonics.
void evaluate_basis(double x, double y, double z, int bands, double* values) noexcept;

}  // namespace welkin::math
