// An environment that shows by itself how it is turned.
#pragma once

#include "welkin/core.h"
#include "welkin/image.h"

namespace WELKIN_EXPORT welkin {

/// A labelled sphere: each of the six sides has its colour, and its axis written on it in letters that read from
/// inside the sphere ("+X", "-Y", ...), a grid of latitudes and longitudes, edges of the faces, and an arrow
/// towards +y on each side wall. In a mirrored picture the letters are mirrored too.
/// `width` x `height` texels of a lat-long. Cost: some 0.5 microseconds a texel and thread.
/// Throws `Error`: invalid_argument out of LatLongView's range, cancelled.
[[nodiscard]] LatLongImage test_map_lat_long(int width, int height, const Control& control = {});

/// The same as a cubemap in the frames of `CubemapView`.
[[nodiscard]] CubemapImage test_map_cubemap(int size, const Control& control = {});

}  // namespace welkin
