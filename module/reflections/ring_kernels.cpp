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

// Plain loops, which the compiler vectorises: the order of operations is that of the source.
void halve_row(const HalvedRow& row, float* rgb) {
  constexpr int block = 32;  // texels of the result
  constexpr int beyond = 2;  // of it that lie beyond either end
  constexpr int margin = 3 * HalvedRow::kMargin;
  const int floats = 3 * row.size;
  float* const light = row.room + margin;
  for (int k = 0; k < margin; ++k) row.room[k] = light[floats + k] = 0.0F;
  for (int first = 0; first < floats; first += kWidth) {
    Lanes sum(0.0F);
    for (int k = 0; k < row.count; ++k) {
      sum += Lanes(row.shares[k]) *
             (Lanes::load_unaligned(row.rows[k] + first) * Lanes::load_unaligned(row.angles[k] + first));
    }
    sum.store_unaligned(light + first);
  }
  const int half = row.size / 2;
  const int count = half + 2 * beyond;
  float sums[6 * block];
  for (int first = 0; first < count; first += block) {
    const int texels = count - first < block ? count - first : block;
    const float* const from = row.room + 6 * first;
    for (int k = 0; k < 6 * texels; ++k) {
      sums[k] = (from[k] + from[k + 21]) * kHalvedShares[0] + (from[k + 3] + from[k + 18]) * kHalvedShares[1] +
                (from[k + 6] + from[k + 15]) * kHalvedShares[2] + (from[k + 9] + from[k + 12]) * kHalvedShares[3];
    }
    for (int i = 0; i < texels; ++i) {
      for (int c = 0; c < 3; ++c) row.room[3 * (first + i) + c] = sums[6 * i + c];
    }
  }
  float* const inside = row.room + 3 * beyond;
  for (int end = 0; end < 2; ++end) {
    const int step = end == 0 ? 3 : -3;
    float* const at = inside + (end == 0 ? 0 : 3 * (half - 1));
    for (int k = 0; k < kFolded; ++k) {
      for (int c = 0; c < 3; ++c)
        at[step * k + c] += at[c - step] * kFirstBeyond[k] + at[c - 2 * step] * kSecondBeyond[k];
    }
  }
  for (int i = 0; i < half; ++i) {
    for (int c = 0; c < 3; ++c) rgb[3 * i + c] = inside[3 * i + c] * row.scale[i];
  }
}

}  // namespace

const RingKernels ring_kernels_table = {
    .sum_ring_taps = sum_ring_taps,
    .halve_row = halve_row,
};

}  // namespace welkin::reflections::WELKIN_ISA
