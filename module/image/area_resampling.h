// Light moved from a lat-long's texels to a cube's, and back, by the area that they have in common.
#pragma once

#include <array>
#include <cstddef>

#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {

/// Writes six faces of `size` x `size` RGB floats, packed, in the frames of `CubemapView`: `to_cubemap` by
/// ResampleFilter::area, without a turn. The view and the size are checked already. The first call for sizes costs a
/// few times as much as those that follow, for which weights are kept (TileWeightTable). Throws `Error` (cancelled).
void fill_cubemap_by_area(const LatLongView& source, int size, const std::array<float*, 6>& faces,
                          const Control& control);

/// Writes width x height RGB floats, packed: each texel is the mean of the cube's texels, taken as areas of one value
/// each, over its own area (edges in steps as CubeTiling has them). Every texel of the cube keeps its total radiance to
/// rounding, and so does a uniform cube its value to 2e-7: what the prefilter's transform wants, and not smooth where
/// the lat-long is finer than the cube. Takes 24 bytes a texel of the result. The view and the sizes are checked
/// already. The same bits on any number of threads. Throws `Error` (cancelled).
void fill_lat_long_by_area(const CubemapView& source, int width, int height, float* rgb, const Control& control);

}  // namespace welkin::image
