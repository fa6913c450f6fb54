// The reference for projections: textbook formulas in double.
#pragma once

#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

/// Returns what `project` computes, by readable code in double: texel by texel, without shared tables, on one thread,
/// and hundreds of times slower. Throws `Error` as `project` does.
[[nodiscard]] SphericalHarmonics reference_projection(const CubemapView& cubemap,
                                                      const ProjectionOptions& options = {});
[[nodiscard]] SphericalHarmonics reference_projection(const LatLongView& lat_long,
                                                      const ProjectionOptions& options = {});

}  // namespace welkin
