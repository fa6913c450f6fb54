// The kernel of filtered importance sampling: a texel's taps, 16 at a time.
#pragma once

#include <cstdint>

#include "simd/dispatch.h"

namespace welkin::reflections {

/// The level of the source's mip chain that each of 16 taps reads: six faces of (size + 2)^2 texels, one beyond each
/// edge, four floats a texel.
struct TapLevel {
  const float* texels[simd::kLanes];
  alignas(64) float size[simd::kLanes];  ///< texels along an edge of a face
  alignas(64) float weight[simd::kLanes];
};

/// 16 taps in the frame whose z axis is the texel's direction. Lanes that have no tap have weights of 0; their other
/// members are those of a tap.
struct TapGroup {
  alignas(64) float x[simd::kLanes];
  alignas(64) float y[simd::kLanes];
  alignas(64) float z[simd::kLanes];
  TapLevel fine;
  TapLevel coarse;
  bool two_levels;  ///< whether any weight of `coarse` is not 0
};

/// A texel's direction and two axes across it: unit and at right angles.
struct TapFrame {
  float x[3];
  float y[3];
  float z[3];
};

/// Writes the sum of all taps' bilinear interpolations times their weights to three floats.
using SumTaps = void (*)(const TapGroup* groups, int count, const TapFrame& frame, float* rgb);

struct SampledKernels {
  SumTaps sum_taps;
};
WELKIN_KERNEL_TABLES(SampledKernels, sampled_kernels)

}  // namespace welkin::reflections
