// A cubemap on rings of latitude.
#pragma once

#include "projection/sanitized_pixels.h"
#include "reflections/prefilter.h"
#include "welkin/control.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// A packed RGB float cubemap as a lat-long of 2 rows x rows texels, each the mean of the cube's texels over its area.
/// Where rows is a multiple of the faces' 2 size, a cube's texel is cut into as many parts first: edges between texels
/// are followed in steps of a part, not of a texel. The same bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] LatLongImage rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

// Radiance so large that sums over it would leave the range of floats, or so small that they would lose bits.

/// The power of two that a picture is to be multiplied by before it is transformed: 2^-64 where a magnitude is above
/// 1e30, 2^100 where none is above 1e-25, 1 elsewhere and of black.
[[nodiscard]] float safe_scale(const projection::SanitizedSource& source) noexcept;

/// The picture times that: exact, but for what is 1e50 times darker than the brightest.
[[nodiscard]] LatLongImage scaled(const projection::SanitizedSource& source, const LatLongView& view, float scale);
[[nodiscard]] CubemapImage scaled(const projection::SanitizedSource& source, const CubemapView& view, float scale);

/// What was made of such a picture over the same scale. No value rounds beyond the floats.
void undo_scale(Prefiltered& result, float scale);

}  // namespace welkin::reflections
