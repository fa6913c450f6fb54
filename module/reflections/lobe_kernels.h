// The kernels of lights that are blurred by a lobe, and of a lobe's spectrum.
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

  /// A `KernelTable`, by which lights are seen instead; null: GGX.
  const float* lines = nullptr;
  int cells = 0;
  float first_cell = 0.0F;
  float cells_of_s = 0.0F;
  float nearest = 0.0F;  ///< square of the distance of a light, less and more of which nothing is seen
  float farthest = 4.0F;
  const float* twice_integrated = nullptr;  ///< and the parts of lights that the horizon cuts
  int cosine_cells = 0;
  float cells_of_c = 0.0F;
  float small = 0.0F;    ///< most `CutLight::least` over which the kernel is all but a cubic
  bool annular = false;  ///< `Lobe::annular`
};
inline constexpr int kLobeTexels = simd::kLanes;

/// A quadrature of a zonal lobe, in blocks of `kMomentLanes` nodes.
struct MomentRun {
  const double* distances;  ///< 1 - c of each node
  const double* weights;
  int blocks;
  const double* factors;  ///< [bands][2]: l / (l + 1), (2 l + 1) / (l + 1)
  int bands;
};
inline constexpr int kMomentLanes = 8;

struct LobeKernels {
  /// Adds for each texel the sum over the runs' lights of colour max(0, c) / (alpha^2 + (1 - c) (1 - alpha^2) / 2)^2, c
  /// = cosine between texel and light, to sums[3][count]: relative error 2e-6 + 1e-7 / alpha for positive light. Of cut
  /// lights max(0, c) is its mean over the parallelogram, error 1e-7 + 1e-4 of its size; they are so far off that all
  /// of the lobe is in that part. A kernel by its table is integrated over a cut light exactly, as a function of the
  /// cosine, where the horizon meets the light. Elsewhere it is summed at 2 x 2 or 3 x 3 points, or an annular one at
  /// three cosines.
  void (*sum_lobes)(const LobeBlock& texels, const LobeLight* lights, const LobeRun* runs, int run_count, float* sums);
  void (*sum_cut_lobes)(const LobeBlock& texels, const CutLight* lights, const LobeRun* runs, int run_count,
                        float* sums);

  /// sums[l][kMomentLanes] += weight P_l(1 - distance) of each lane's nodes, block after block.
  ///
  /// By differences, d_l = P_l - P_(l-1): (l + 1) d_(l+1) = l d_l - (2 l + 1) x P_l, x the distance. Near x = 0 the
  /// usual recurrence subtracts numbers close to each other; this one keeps x's own digits.
  void (*sum_moments)(const MomentRun& run, double* sums);
};
WELKIN_KERNEL_TABLES(LobeKernels, lobe_kernels)

}  // namespace welkin::reflections
