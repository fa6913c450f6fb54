// The kernel of lights that are blurred by a GGX lobe.
#pragma once

#include "simd/dispatch.h"

namespace welkin::reflections {

/// A light of no extent.
struct LobeLight {
  float x, y, z;           ///< unit direction
  float red, green, blue;  ///< radiance times steradians
};

/// A light on a parallelogram so small that the lobe is even over it but for the horizon: its points are at the
/// direction + s along + t down, s and t from -1 to 1.
struct CutLight {
  LobeLight light;
  float along[3];
  float down[3];
  float least;  ///< how far c changes from its middle to an edge, at least: a hundredth of its size
};

/// Lights that lie one after the other.
struct LobeRun {
  int first;
  int count;
};

/// Texels of a cubemap's face, a multiple of `kLobeTexels`, and the lobe. A texel's centre is at normal + u along +
/// v down.
struct LobeBlock {
  float normal[3];
  float along[3];
  float down[3];
  const float* u;  ///< of each texel, -1 to 1
  const float* v;
  int count;
  float alpha_squared;
  float half_slope;  ///< (1 - alpha^2) / 4

  /// 0: the whole lobe. Else only its far part (see `kFarPart`), and this is 1 / (end (1 - alpha^2)).
  float far_scale;
};
inline constexpr int kLobeTexels = simd::kLanes;

/// Adds for each texel the sum over the runs' lights of colour max(0, c) / (alpha^2 + (1 - c) (1 - alpha^2) / 2)^2, c
/// = cosine between texel and light, to sums[3][count]: relative error 2e-6 + 1e-7 / alpha for positive light. Of cut
/// lights max(0, c) is its mean over the parallelogram, error 1e-7 + 1e-4 of its size; they are so far off that all of
/// the lobe is in that part.
using SumLobes = void (*)(const LobeBlock& texels, const LobeLight* lights, const LobeRun* runs, int run_count,
                          float* sums);
using SumCutLobes = void (*)(const LobeBlock& texels, const CutLight* lights, const LobeRun* runs, int run_count,
                             float* sums);

struct LobeKernels {
  SumLobes sum_lobes;
  SumCutLobes sum_cut_lobes;
};
WELKIN_KERNEL_TABLES(LobeKernels, lobe_kernels)

}  // namespace welkin::reflections
