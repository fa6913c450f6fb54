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

// A texel of a face gives its light to the four nearest of half as many along each axis, so that the light of all of
// them as areas has the texel's own moments up to the third.

/// Shares of texels that lie 7/4, 5/4, 3/4 and 1/4 of a large texel from its middle.
inline constexpr float kHalvedShares[4] = {-6.0F / 128.0F, -10.0F / 128.0F, 34.0F / 128.0F, 110.0F / 128.0F};
/// The same shares by what would lie beyond the face's edge, once and twice: parabolas through the first
/// three within it, by which uniform light stays uniform and moments up to the second remain.
inline constexpr int kFolded = 3;
inline constexpr float kFirstBeyond[kFolded] = {3.0F, -3.0F, 1.0F};
inline constexpr float kSecondBeyond[kFolded] = {6.0F, -8.0F, 3.0F};

/// light[k] = radiance[k] steradians[k].
using WeighLight = void (*)(const float* radiance, const float* steradians, int count, float* light);

/// Rows of a face's light that give to one row of a face of half as many texels.
struct HalvedRow {
  static constexpr int kMostRows = 9;
  static constexpr int kMargin = 7;  ///< texels of `room` beyond both ends

  const float* light[kMostRows];  ///< packed RGB, radiance times steradians
  float shares[kMostRows];
  int count;                          ///< rows
  int size;                           ///< texels of a row: even, at least 16
  const float* scale;                 ///< of each texel of the result
  float* room;                        ///< 3 (size + 2 kMargin) + kBeyond floats
  static constexpr int kBeyond = 32;  ///< that registers may read
};

/// Light of the rows times their shares, row after row; then along the row as `halved_faces` shares it out.
using HalveRow = void (*)(const HalvedRow& row, float* rgb);

struct RingKernels {
  SumRingTaps sum_ring_taps;
  WeighLight weigh_light;
  HalveRow halve_row;
};
WELKIN_KERNEL_TABLES(RingKernels, ring_kernels)

}  // namespace welkin::reflections
