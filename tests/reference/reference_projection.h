// The truth that projections are measured against: textbook formulas in double.
#pragma once

#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

/// What `project` computes, by its readable double-precision twin: one texel after the other, no shared tables, one
/// thread, hundreds of times slower. Throws `Error` as `project` does.
[[nodiscard]] SphericalHarmonics reference_projection(const CubemapView& cubemap,
                                                      const ProjectionOptions& options = {});
[[nodiscard]] SphericalHarmonics reference_projection(const LatLongView& lat_long,
                                                      const ProjectionOptions& options = {});

}  // namespace welkin
