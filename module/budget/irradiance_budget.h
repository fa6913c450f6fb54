// What an environment has beyond its first bands.
#pragma once

#include "welkin/error_budget.h"

namespace welkin::budget {

/// `radiance`: the first bands of the same pixels. Reads every pixel once. Throws `Error` as `project`.
[[nodiscard]] HighBands high_bands(const CubemapView& view, const SphericalHarmonics& radiance,
                                   const ProjectionOptions& options, const Control& control);
[[nodiscard]] HighBands high_bands(const LatLongView& view, const SphericalHarmonics& radiance,
                                   const ProjectionOptions& options, const Control& control);

}  // namespace welkin::budget
