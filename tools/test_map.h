// Drawn environments: one that shows its orientation, and a living room in the evening sun to try Welkin with.
#pragma once

#include <glm/mat3x3.hpp>

#include "welkin/core.h"
#include "welkin/image.h"

namespace WELKIN_EXPORT welkin {

/// The axes that the map names, and the positions of its cubemap's faces.
struct TestMapAxes {
  glm::dmat3 names{1.0};   ///< from Welkin's axes to the written axes: one of the cube's symmetries
  glm::dmat3 places{1.0};  ///< from Welkin's axes to positions in the cubemap: one of the cube's symmetries
};

/// Draws a labelled sphere: each of the six sides has its colour, and its axis written on it in letters that read from
/// inside the sphere ("+X", "-Y", ...), a grid of latitudes and longitudes, edges of the faces, and an arrow towards +y
/// on each side wall. In a mirrored image the letters are mirrored too. Other axes change the names and colours, but
/// not what is in front, on the left or above. `width` x `height`: texels of a lat-long. Cost: about 0.5 microseconds
/// per texel on one thread. Throws `Error`: invalid_argument out of LatLongView's range, cancelled.
[[nodiscard]] LatLongImage test_map_lat_long(int width, int height, const Control& control = {},
                                             const TestMapAxes& axes = {});

/// Draws the test map as a cubemap in the frames of `CubemapView`.
[[nodiscard]] Cubemap test_map_cubemap(int size, const Control& control = {}, const TestMapAxes& axes = {});

/// Draws a room of diffuse boxes as a viewer in its middle sees it: a window to the west (+x, the left quarter of the
/// image) with the low sun and the sky, a floor lamp, and three bulbs over a table. Light is reflected three times.
/// Radiance runs from 0.001 in dark corners to 30 000 in the sun's disc, in no particular unit.
/// `width` x `height`: texels of the image. The same bits on every machine. Throws `Error`: invalid_argument for
/// sizes out of LatLongView's range, cancelled.
[[nodiscard]] LatLongImage sample_room(int width, int height, const Control& control = {});

}  // namespace welkin
