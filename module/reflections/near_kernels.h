// Kernels of near sums: what a lobe's near part has over each texel of a face.
#pragma once

#include <cstdint>

#include "reflections/ring_kernels.h"
#include "simd/dispatch.h"

namespace welkin::reflections {

/// Two points a texel, or four, along each axis.
inline constexpr int kNearPoints = 2;
inline constexpr int kFineNearPoints = 4;

/// Texels of a face as one direction has them about it.
struct NearTexels {
  const float* columns;  ///< their middles, across the face from -1 to 1; with others up to a whole group of 16
  const float* rows;
  int count;
  float direction[3];  ///< in the face's frame: with the columns, with the rows, and outwards
  float half;          ///< of a texel's edge
  float offset;        ///< q / end of the lobe's split, see `kFarPart`
  float inverse_end;
};

/// Writes the near part's integral over each texel, but for a factor that all have in common; up to a whole group.
using WeighNear = void (*)(const NearTexels& texels, float* weights);
/// Returns the sum of weights, of which there are a whole group's, sixteen at a time.
using SumNear = double (*)(const float* weights, int count);
/// Writes taps of records that follow each other from `record` on.
using WriteNearTaps = void (*)(const float* weights, float scale, std::uint32_t record, int count, RingTap* taps);

struct NearKernels {
  WeighNear weigh;
  WeighNear weigh_finely;
  SumNear sum;
  WriteNearTaps write_taps;
};
WELKIN_KERNEL_TABLES(NearKernels, near_kernels)

}  // namespace welkin::reflections
