// Solid angles of texels, for statistics.
#pragma once

#include <span>

namespace welkin::codec {

/// Steradians of each texel in row `row` of a lat-long of `width` x `height`: all texels of a row are equal.
[[nodiscard]] double lat_long_texel_solid_angle(int width, int height, int row);

/// Writes the steradians of the texels in row `row` of a cubemap face to `row_angles` (`size` of them, the
/// face's edge). Relative error below 1e-11.
void cubemap_row_solid_angles(int row, std::span<double> row_angles);

}  // namespace welkin::codec
