// Harmonics summed at many directions.
#include "simd/kernel_table.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

WELKIN_INLINE DoubleLanes points(double start, double step, DoubleLanes u) {
  return DoubleLanes(start) + DoubleLanes(step) * u;
}

}  // namespace

void evaluate_harmonics(const DirectionRun& run, const BasisRecurrence& recurrence, const double* coefficients,
                        int bands, float* rgb) {
  const double* const red = coefficients;
  const double* const green = red + bands * bands;
  const double* const blue = green + bands * bands;
  for (int first = 0; first < run.count; first += kDoubleWidth) {
    const int part = run.count - first < kDoubleWidth ? run.count - first : kDoubleWidth;
    alignas(64) double lanes[3][kDoubleWidth] = {};
    for (int k = 0; k < part; ++k) lanes[0][k] = run.u[first + k];
    for (int k = part; k < kDoubleWidth; ++k) lanes[0][k] = run.u[first];
    const DoubleLanes u = DoubleLanes::load_aligned(lanes[0]);
    const DoubleLanes x = points(run.start[0], run.step[0], u);
    const DoubleLanes y = points(run.start[1], run.step[1], u);
    const DoubleLanes z = points(run.start[2], run.step[2], u);
    const DoubleLanes scale = DoubleLanes(1.0) / xsimd::sqrt(x * x + y * y + z * z);
    DoubleLanes sums[3] = {DoubleLanes(0.0), DoubleLanes(0.0), DoubleLanes(0.0)};
    for_each_basis_value(
        recurrence, x * scale, y * scale, z * scale, DoubleLanes(1.0),
        bands, [&](int index, DoubleLanes value) __attribute__((always_inline)) {
          sums[0] = sums[0] + DoubleLanes(red[index]) * value;
          sums[1] = sums[1] + DoubleLanes(green[index]) * value;
          sums[2] = sums[2] + DoubleLanes(blue[index]) * value;
        });
    for (int c = 0; c < 3; ++c) sums[c].store_aligned(lanes[c]);
    for (int k = 0; k < part; ++k) {
      for (int c = 0; c < 3; ++c) rgb[3 * (first + k) + c] = static_cast<float>(lanes[c][k]);
    }
  }
}

}  // namespace welkin::simd::WELKIN_ISA
