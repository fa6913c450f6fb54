// Sums over a cubemap's points, of sixteen images at a time.
#include "reflections/ring_kernels.h"

#include <algorithm>
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

void gather_images(const ImageRows& rows, float* records) {
  const float* from[kRingImages];
  for (int image = 0; image < kRingImages; ++image) from[image] = rows.from[image];
  for (int point = 0; point < rows.count; ++point, records += kRecordFloats) {
    // Each writes one float too many, which the next one writes again.
    for (int image = 0; image + 1 < kRingImages; ++image) {
      Quad::load_unaligned(from[image]).store_unaligned(records + 3 * image);
      from[image] += rows.step[image];
    }
    constexpr int last = kRingImages - 1;
    for (int c = 0; c < 3; ++c) records[3 * last + c] = from[last][c];
    from[last] += rows.step[last];
  }
}

/// Texels times registers that are summed at a time.
constexpr int kGroupRegisters = kRegisters <= 3 ? kRegisters : 2;

/// Taps whose sum starts at 0: of thousands of them in one go, even light would lose some 1e-5.
constexpr std::ptrdiff_t kTapsInARow = 64;

void add_group_taps(const TexelGroup& group, float (&sums)[kTexelsOfGroup][kRecordFloats]) {
  for (int part = 0; part < kRegisters; part += kGroupRegisters) {
    Lanes sum[kTexelsOfGroup][kGroupRegisters];
    for (auto& texel : sum) {
      for (Lanes& lanes : texel) lanes = Lanes(0.0F);
    }
    for (const GroupTap* tap = group.taps; tap != group.end; ++tap) {
      const float* const record = group.records + static_cast<std::size_t>(tap->record) * kRecordFloats + part * kWidth;
      Lanes values[kGroupRegisters];
      for (int r = 0; r < kGroupRegisters; ++r) values[r] = Lanes::load_aligned(record + r * kWidth);
      for (int texel = 0; texel < kTexelsOfGroup; ++texel) {
        const Lanes weight(tap->weights[texel]);
        for (int r = 0; r < kGroupRegisters; ++r) sum[texel][r] += weight * values[r];
      }
    }
    for (int texel = 0; texel < kTexelsOfGroup; ++texel) {
      for (int r = 0; r < kGroupRegisters; ++r) {
        float* const to = sums[texel] + (part + r) * kWidth;
        (Lanes::load_aligned(to) + sum[texel][r]).store_aligned(to);
      }
    }
  }
}

void sum_group_taps(const TexelGroup& group, float (&sums)[kTexelsOfGroup][kRecordFloats]) {
  for (auto& texel : sums) {
    for (float& sum : texel) sum = 0.0F;
  }
  for (const GroupTap* tap = group.taps; tap != group.end;) {
    const GroupTap* const end = tap + std::min(kTapsInARow, group.end - tap);
    add_group_taps({group.records, tap, end}, sums);
    tap = end;
  }
}

}  // namespace

const RingKernels ring_kernels_table = {
    .sum_ring_taps = sum_ring_taps,
    .gather_images = gather_images,
    .sum_group_taps = sum_group_taps,
};

}  // namespace welkin::reflections::WELKIN_ISA
