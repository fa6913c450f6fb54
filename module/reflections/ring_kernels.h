// Kernels that take a cubemap to rings of latitude or to texels of blurred mips, sixteen images at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/dispatch.h"

namespace welkin::reflections {

/// A sixteenth of the sphere has so many mirror images and quarter turns, itself one of them; a record is a texel of it
/// as all images have it, [image][red, green, blue].
inline constexpr int kRingImages = 16;
inline constexpr int kRecordFloats = 3 * kRingImages;

/// A texel of the cube and its weight in a ring's texel.
struct RingTap {
  std::uint32_t record;
  float weight;
};

/// Texels of a ring within the sixteenth.
struct RingRun {
  const float* records;
  const RingTap* taps;
  const std::uint32_t* ends;  ///< [count + 1]: the taps of texel k are from ends[k] up to ends[k + 1]
  int count;
};

/// Where the images of a ring's texels go: image i's of texel k to to[i] + step[i] k.
struct RingPlacesInMemory {
  float* to[kRingImages];
  std::ptrdiff_t step[kRingImages];
};

/// Sums of weight times record, tap after tap.
using SumRingTaps = void (*)(const RingRun& run, const RingPlacesInMemory& places);

/// Points in a row that become records: image i's of point k is at from[i] + step[i] k. A float more than the last
/// point's three can be read.
struct ImageRows {
  const float* from[kRingImages];
  std::ptrdiff_t step[kRingImages];
  int count;
};

/// Copies them to records side by side.
using GatherImages = void (*)(const ImageRows& rows, float* records);

/// Texels that are summed together, as most of their taps are of the same records.
inline constexpr int kTexelsOfGroup = 4;

struct GroupTap {
  std::uint32_t record;
  float weights[kTexelsOfGroup];
};

/// Taps from `taps` up to `end`; sums[texel] are those of all images.
struct TexelGroup {
  const float* records;
  const GroupTap* taps;
  const GroupTap* end;
};

/// Sums of weight times record, of 64 taps at a time, one after the other; `sums` on a cache line.
using SumGroupTaps = void (*)(const TexelGroup& group, float (&sums)[kTexelsOfGroup][kRecordFloats]);

struct RingKernels {
  SumRingTaps sum_ring_taps;
  GatherImages gather_images;
  SumGroupTaps sum_group_taps;
};
WELKIN_KERNEL_TABLES(RingKernels, ring_kernels)

}  // namespace welkin::reflections
