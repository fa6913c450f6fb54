// With the notation of simd/basis_recurrence.h, f = sum over m of A_m(z) C_m(x, y) + B_m(z) S_m(x, y), where
// A_m = sum over l of c(l, m) q(l, m) and B_m the same with c(l, -m). C_m + i S_m = (x + i y)^m has
//   d/dx (C_m, S_m) = m (C_(m-1), S_(m-1)),   d/dy (C_m, S_m) = m (-S_(m-1), C_(m-1)),
// and q's derivatives obey its own recurrence, differentiated once and twice.
#include "sh/harmonic_derivatives.h"

#include "tables/basis_constants.h"

namespace welkin::sh {
namespace {

/// A function of z with its first two derivatives.
struct Column {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;

  void add(double factor, const Column& other) noexcept {
    value += factor * other.value;
    slope += factor * other.slope;
    curvature += factor * other.curvature;
  }
};

struct Orders {
  Column a;  ///< A_m
  Column b;  ///< B_m
};

Orders sum_over_bands(std::span<const double> coefficients, int bands, int m, double z) noexcept {
  const simd::BasisRecurrence& recurrence = tables::basis_constants();
  Orders sums;
  Column before;
  Column here{recurrence.start[m], 0.0, 0.0};
  for (int l = m;;) {
    const auto centre = static_cast<std::size_t>(l * (l + 1));
    const auto order = static_cast<std::size_t>(m);
    sums.a.add(coefficients[centre + order], here);
    if (m > 0) sums.b.add(coefficients[centre - order], here);
    if (++l == bands) return sums;
    const double a = recurrence.a[m][l];
    const double b = recurrence.b[m][l];
    const Column next{a * (z * here.value) - b * before.value, a * (z * here.slope + here.value) - b * before.slope,
                      a * (z * here.curvature + 2.0 * here.slope) - b * before.curvature};
    before = here;
    here = next;
  }
}

}  // namespace

HarmonicDerivatives harmonic_derivatives(std::span<const double> coefficients, int bands,
                                         const glm::dvec3& direction) noexcept {
  HarmonicDerivatives d{0.0, glm::dvec3(0.0), glm::dmat3(0.0)};
  // C and S of orders m, m - 1 and m - 2.
  double cosine[3] = {1.0, 0.0, 0.0};
  double sine[3] = {0.0, 0.0, 0.0};
  for (int m = 0; m < bands; ++m) {
    const auto [a, b] = sum_over_bands(coefficients, bands, m, direction.z);
    const double once = m;
    const double twice = once * (once - 1.0);
    d.value += a.value * cosine[0] + b.value * sine[0];
    d.gradient.x += once * (a.value * cosine[1] + b.value * sine[1]);
    d.gradient.y += once * (b.value * cosine[1] - a.value * sine[1]);
    d.gradient.z += a.slope * cosine[0] + b.slope * sine[0];
    d.hessian[0][0] += twice * (a.value * cosine[2] + b.value * sine[2]);
    d.hessian[0][1] += twice * (b.value * cosine[2] - a.value * sine[2]);
    d.hessian[0][2] += once * (a.slope * cosine[1] + b.slope * sine[1]);
    d.hessian[1][2] += once * (b.slope * cosine[1] - a.slope * sine[1]);
    d.hessian[2][2] += a.curvature * cosine[0] + b.curvature * sine[0];
    const double next_cosine = direction.x * cosine[0] - direction.y * sine[0];
    const double next_sine = direction.x * sine[0] + direction.y * cosine[0];
    cosine[2] = cosine[1];
    sine[2] = sine[1];
    cosine[1] = cosine[0];
    sine[1] = sine[0];
    cosine[0] = next_cosine;
    sine[0] = next_sine;
  }
  d.hessian[1][1] = -d.hessian[0][0];  // C_m and S_m are harmonic in the plane
  d.hessian[1][0] = d.hessian[0][1];
  d.hessian[2][0] = d.hessian[0][2];
  d.hessian[2][1] = d.hessian[1][2];
  return d;
}

}  // namespace welkin::sh
