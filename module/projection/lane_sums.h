// From sums over groups of lanes to sums in double. Only for kernel sources.
#pragma once

#include "projection/projection_kernels.h"
#include "simd/vec.h"

namespace welkin::projection::WELKIN_ISA {

/// sums[k] += lanes[k] + lanes[k + 8]: that sum in float, the addition to `sums` in double.
WELKIN_INLINE void add_to_double_lanes(const float* lanes, double* sums) {
  alignas(64) float halves[kSumLanes];
  for (int k = 0; k < kSumLanes; k += simd::kNarrowWidth) {
    (simd::NarrowLanes::load_aligned(lanes + k) + simd::NarrowLanes::load_aligned(lanes + k + kSumLanes))
        .store_aligned(halves + k);
  }
  for (int k = 0; k < kSumLanes; k += simd::kDoubleWidth) {
    (simd::DoubleLanes::load_aligned(sums + k) + simd::load_widened(halves + k)).store_aligned(sums + k);
  }
}

}  // namespace welkin::projection::WELKIN_ISA
