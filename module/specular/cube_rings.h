// A cubemap on rings of latitude.
#pragma once

#include "welkin/control.h"
#include "welkin/image.h"

namespace welkin::specular {

/// A packed RGB float cubemap as a lat-long of 2 rows x rows texels, each the mean of the cube's texels over its area.
/// Where rows is a multiple of the faces' 2 size, a cube's texel is cut into as many parts first: edges between texels
/// are followed in steps of a part, not of a texel. The same bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] LatLongImage rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

}  // namespace welkin::specular
