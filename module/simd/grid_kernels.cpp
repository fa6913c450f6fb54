// A grid's values between its texels: 4 x 4 texels of four floats for each point.
//
// Four texels of a ring are the 16 logical lanes. Rings are weighted and added first, as ((0 + 1) + (2 + 3)); then the
// columns: with q0 to q3 the four texels' weighted sums, red to blue = (q0 + q2) + (q1 + q3).
#include "simd/four_texels.h"
#include "simd/kernel_functions.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

/// What is left to be added over the four texels.
WELKIN_INLINE Texels spread_value(const GridRun& run, int point) {
  const float* const weights = run.ring_weights + 4 * static_cast<std::ptrdiff_t>(point);
  const float* const texels =
      run.origin + run.rings[point] * run.ring_stride + 4 * static_cast<std::ptrdiff_t>(run.columns[point]);
  // The next row of points will want the rings below these.
  fetch_line(reinterpret_cast<const char*>(texels + (point % 2 == 0 ? 4 : 5) * run.ring_stride), 0);
  const Texels upper = sum(weighted_ring(texels, weights[0]), weighted_ring(texels + run.ring_stride, weights[1]));
  const Texels lower = sum(weighted_ring(texels + 2 * run.ring_stride, weights[2]),
                           weighted_ring(texels + 3 * run.ring_stride, weights[3]));
  return weighted_columns(sum(upper, lower), run.column_weights + 4 * static_cast<std::ptrdiff_t>(point));
}

#if defined(__AVX512F__)

/// Points `point` to `point` + 3: the folds of all four at once, then the unused fourth values squeezed out.
WELKIN_INLINE void sample_four(const GridRun& run, int point, __m512 lowest, float* rgb) {
  const __m512 rgba = folded(spread_value(run, point), spread_value(run, point + 1), spread_value(run, point + 2),
                             spread_value(run, point + 3));
  const __m512i order = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
  const __m512 packed = _mm512_permutexvar_ps(order, _mm512_max_ps(rgba, lowest));
  _mm512_mask_storeu_ps(rgb, 0x0FFF, packed);
}

#endif

}  // namespace

void sample_grid(const GridRun& run, float* rgb) {
  constexpr float most_negative = -__builtin_inff();
  const float lowest = run.not_negative ? 0.0F : most_negative;
  int point = 0;
#if defined(__AVX512F__)
  for (; point + 4 <= run.count; point += 4) sample_four(run, point, _mm512_set1_ps(lowest), rgb + 3 * point);
#else
  // Four values are written; the fourth is the next point's red, which comes later.
  for (; point + 1 < run.count; ++point) {
    _mm_storeu_ps(rgb + 3 * point, _mm_max_ps(folded(spread_value(run, point)), _mm_set1_ps(lowest)));
  }
#endif
  for (; point < run.count; ++point) {
    alignas(16) float value[4];
    _mm_store_ps(value, _mm_max_ps(folded(spread_value(run, point)), _mm_set1_ps(lowest)));
    for (int c = 0; c < 3; ++c) rgb[3 * point + c] = value[c];
  }
}

}  // namespace welkin::simd::WELKIN_ISA
