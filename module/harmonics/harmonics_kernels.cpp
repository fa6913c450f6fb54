// Harmonics at many points at once.
#include "harmonics/harmonics_kernels.h"

#include <cstddef>

#include "simd/vec.h"

namespace welkin::harmonics::WELKIN_ISA {
namespace {

using simd::DoubleLanes, simd::kDoubleWidth;

void evaluate(const math::BasisRecurrence& recurrence, int bands, const double* axes, int count, double* basis) {
  for (int p = 0; p < count; p += kDoubleWidth) {
    math::for_each_basis_value(
        recurrence, DoubleLanes::load_aligned(axes + p), DoubleLanes::load_aligned(axes + count + p),
        DoubleLanes::load_aligned(axes + 2 * count + p), DoubleLanes(1.0), bands,
        [&](int index, DoubleLanes value)
            WELKIN_INLINE_LAMBDA { value.store_aligned(basis + std::ptrdiff_t{index} * count + p); });
  }
}

void sum(const double* coefficients, int functions, const double* basis, int count, double* values) {
  for (int p = 0; p < count; p += kDoubleWidth) {
    DoubleLanes red(0.0);
    DoubleLanes green(0.0);
    DoubleLanes blue(0.0);
    const double* at = basis + p;
    for (int f = 0; f < functions; ++f, at += count) {
      const DoubleLanes here = DoubleLanes::load_aligned(at);
      red = red + DoubleLanes(coefficients[3 * f]) * here;
      green = green + DoubleLanes(coefficients[3 * f + 1]) * here;
      blue = blue + DoubleLanes(coefficients[3 * f + 2]) * here;
    }
    red.store_aligned(values + p);
    green.store_aligned(values + count + p);
    blue.store_aligned(values + 2 * count + p);
  }
}

/// Lanes to their sum.
WELKIN_INLINE double folded(const double* lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

void integrate(const double* values, const double* basis, int functions, int count, double* coefficients) {
  for (int f = 0; f < functions; ++f, basis += count) {
    alignas(64) double lanes[3][kPointLanes];
    for (int part = 0; part < kPointLanes; part += kDoubleWidth) {
      DoubleLanes red(0.0);
      DoubleLanes green(0.0);
      DoubleLanes blue(0.0);
      for (int p = part; p < count; p += kPointLanes) {
        const DoubleLanes here = DoubleLanes::load_aligned(basis + p);
        red = red + DoubleLanes::load_aligned(values + p) * here;
        green = green + DoubleLanes::load_aligned(values + count + p) * here;
        blue = blue + DoubleLanes::load_aligned(values + 2 * count + p) * here;
      }
      red.store_aligned(lanes[0] + part);
      green.store_aligned(lanes[1] + part);
      blue.store_aligned(lanes[2] + part);
    }
    for (int c = 0; c < 3; ++c) coefficients[3 * f + c] = folded(lanes[c]);
  }
}

}  // namespace

const HarmonicsKernels harmonics_kernels_table = {.evaluate = evaluate, .sum = sum, .integrate = integrate};

}  // namespace welkin::harmonics::WELKIN_ISA
