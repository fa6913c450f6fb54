// Kernels that take a cubemap to rings of latitude, sixteen images at a time.
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

struct RingKernels {
  SumRingTaps sum_ring_taps;
};
WELKIN_KERNEL_TABLES(RingKernels, ring_kernels)

}  // namespace welkin::reflections
