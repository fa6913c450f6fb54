// The kernels of the BRDF tables: directional albedo, sixteen view angles at a time.
#pragma once

#include "simd/dispatch.h"

namespace welkin::reflections {

/// A product rule for the integrals of `directional_albedo` and `sheen_albedo` (reflections/brdf_table.h).
struct AlbedoRule {
  int azimuths;
  const float* azimuth_cosines;
  const float* azimuth_weights;
  int radii;
  const float* radius_positions;  ///< in (0, 1)
  const float* radius_weights;
};

/// e^-13: where the GGX integral ends, its tail being below 1e-6.
inline constexpr float kAlbedoTail = 2.26e-6F;
/// The sheen integral ends where its density is e^-14 of the largest.
inline constexpr float kSheenTail = 14.0F;

struct BrdfKernels {
  /// For sixteen cosines against the normal: directional albedo of GGX with Fresnel 1 (`whole`), and the part of it
  /// that Schlick's (1 - v.h)^5 weighs (`fresnel`). 0 < alpha <= 1.
  void (*directional_albedo)(const AlbedoRule& rule, float alpha, const float* normal_view, float* whole,
                             float* fresnel);

  /// For sixteen cosines against the normal: directional albedo of Charlie sheen.
  void (*sheen_albedo)(const AlbedoRule& rule, float alpha, const float* normal_view, float* albedo);
};
WELKIN_KERNEL_TABLES(BrdfKernels, brdf_kernels)

}  // namespace welkin::reflections
