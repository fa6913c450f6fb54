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

void weigh_light(const float* radiance, const float* steradians, int count, float* light) {
  int k = 0;
  for (; k + kWidth <= count; k += kWidth)
    (Lanes::load_unaligned(radiance + k) * Lanes::load_unaligned(steradians + k)).store_unaligned(light + k);
  for (; k < count; ++k) light[k] = radiance[k] * steradians[k];
}

void halve_row(const HalvedRow& row, float* rgb) {
  constexpr int beyond = 2;  // texels of the result that lie beyond either end
  constexpr int margin = 3 * HalvedRow::kMargin;
  const int floats = 3 * row.size;
  float* const light = row.room + margin;
  for (int k = 0; k < margin; ++k) row.room[k] = light[floats + k] = 0.0F;
  for (int k = 0; k < HalvedRow::kBeyond; ++k) light[floats + margin + k] = 0.0F;
  for (int first = 0; first < floats; first += kWidth) {
    Lanes sum(0.0F);
    for (int k = 0; k < row.count; ++k) sum += Lanes(row.shares[k]) * Lanes::load_unaligned(row.light[k] + first);
    sum.store_unaligned(light + first);
  }
  const int half = row.size / 2;
  const int count = half + 2 * beyond;
  const auto sum = [](const float* from, auto zero) {
    using Register = decltype(zero);
    const auto pair = [from](int near, int far) {
      return Register::load_unaligned(from + 3 * near) + Register::load_unaligned(from + 3 * far);
    };
    return pair(0, 7) * Register(kHalvedShares[0]) + pair(1, 6) * Register(kHalvedShares[1]) +
           pair(2, 5) * Register(kHalvedShares[2]) + pair(3, 4) * Register(kHalvedShares[3]);
  };
  // each texel is written as four floats, of which the next one overwrites the fourth
  if constexpr (kWidth > Quad::size) {  // sums between texels of the result cost less than narrow registers
    for (int first = 0; first < 6 * count; first += kWidth)
      sum(row.room + first, Lanes(0.0F)).store_unaligned(row.room + first);
    for (int i = 0; i < count; ++i) Quad::load_unaligned(row.room + 6 * i).store_unaligned(row.room + 3 * i);
  } else {
    for (int i = 0; i < count; ++i) sum(row.room + 6 * i, Quad(0.0F)).store_unaligned(row.room + 3 * i);
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
  for (int i = 0; i + 1 < half; ++i)
    (Quad::load_unaligned(inside + 3 * i) * Quad(row.scale[i])).store_unaligned(rgb + 3 * i);
  for (int c = 3 * half - 3; c < 3 * half; ++c) rgb[c] = inside[c] * row.scale[half - 1];
}

}  // namespace

const RingKernels ring_kernels_table = {
    .sum_ring_taps = sum_ring_taps,
    .weigh_light = weigh_light,
    .halve_row = halve_row,
};

}  // namespace welkin::reflections::WELKIN_ISA
