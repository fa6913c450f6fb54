// An environment to try Welkin with, computed and not photographed: a living room in the evening sun.
#pragma once

#include "welkin/core.h"
#include "welkin/image.h"

namespace WELKIN_EXPORT welkin {

/// Draws a room of diffuse boxes as a viewer in its middle sees it: a window to the west (+x, the left quarter of the
/// picture) with the low sun and the sky, a floor lamp, and three bulbs over a table. Light is reflected three times.
/// Radiance runs from 0.001 in dark corners to 30 000 in the sun's disc, in no particular unit.
/// `width` x `height`: texels of the picture. The same bits on every machine. Throws `Error`: invalid_argument for
/// sizes out of LatLongView's range, cancelled.
[[nodiscard]] LatLongImage sample_room(int width, int height, const Control& control = {});

}  // namespace welkin
