// Sums over a cubemap's points, of sixteen images at a time.
#include "reflections/ring_kernels.h"

#include <cstddef>

#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kWidth, simd::Lanes, simd::Quad;

constexpr int kRegisters = kRecordFloats / kWidth;

/// Registers that are summed at a time: as many as the processor has room for beside the products.
constexpr int kAtATime = kRegisters < 6 ? kRegisters : 6;

void sum_ring_taps(const RingRun& run, const RingPlacesInMemory& places) {
  alignas(64) float sums[kRecordFloats];
  for (int k = 0; k < run.count; ++k) {
    const RingTap* const first = run.taps + run.ends[k];
    const RingTap* const end = run.taps + run.ends[k + 1];
    for (int part = 0; part < kRegisters; part += kAtATime) {
      Lanes sum[kAtATime];
      for (int r = 0; r < kAtATime; ++r) sum[r] = Lanes(0.0F);
      for (const RingTap* tap = first; tap != end; ++tap) {
        const float* const record = run.records + static_cast<std::size_t>(tap->record) * kRecordFloats + part * kWidth;
        const Lanes weight(tap->weight);
        for (int r = 0; r < kAtATime; ++r) sum[r] += weight * Lanes::load_aligned(record + r * kWidth);
      }
      for (int r = 0; r < kAtATime; ++r) sum[r].store_aligned(sums + (part + r) * kWidth);
    }
    for (int image = 0; image < kRingImages; ++image) {
      float* const to = places.to[image] + places.step[image] * k;
      to[0] = sums[3 * image];
      to[1] = sums[3 * image + 1];
      to[2] = sums[3 * image + 2];
    }
  }
}

}  // namespace

const RingKernels ring_kernels_table = {
    .sum_ring_taps = sum_ring_taps,
};

}  // namespace welkin::reflections::WELKIN_ISA
