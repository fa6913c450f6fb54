// The kernels of harmonics: their values at many points, sums of them there, and integrals back to coefficients.
#pragma once

#include "math/basis.h"
#include "simd/dispatch.h"

namespace welkin::harmonics {

/// Points come in multiples of this: as many lanes add up the integrals, whatever the instruction set.
inline constexpr int kPointLanes = 8;

struct HarmonicsKernels {
  /// basis[bands^2][count] = each harmonic at unit directions, axes[3][count].
  void (*evaluate)(const math::BasisRecurrence& recurrence, int bands, const double* axes, int count, double* basis);

  /// values[3][count] = the sum of coefficients[functions][3] times basis[functions][count], in that order.
  void (*sum)(const double* coefficients, int functions, const double* basis, int count, double* values);

  /// coefficients[functions][3] = the sum over points of values[3][count] times basis[functions][count]: lane k of
  /// `kPointLanes` adds up its points, then halves of 4, 2 and 1 lanes are added.
  void (*integrate)(const double* values, const double* basis, int functions, int count, double* coefficients);
};
WELKIN_KERNEL_TABLES(HarmonicsKernels, harmonics_kernels)

}  // namespace welkin::harmonics
