// Radiance so large that sums over it would leave the range of floats.
#pragma once

#include "specular/clean_source.h"
#include "specular/prefilter.h"
#include "welkin/image.h"

namespace welkin::specular {

/// Whether a value is above 1e30 in magnitude: the transform's sums could end at infinity.
[[nodiscard]] bool has_huge_values(const CleanSource& source) noexcept;

/// The picture times 2^-64: exact, but for what is 1e50 times darker than the brightest.
[[nodiscard]] LatLongImage scaled_down(const CleanSource& source, const LatLongView& view);
[[nodiscard]] CubemapImage scaled_down(const CleanSource& source, const CubemapView& view);

/// What was made of such a picture times 2^64. No value rounds beyond the floats.
void scale_up(Prefiltered& result);

}  // namespace welkin::specular
