// Where texels lie on the sphere and how much of it they cover.
#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace welkin::image {

/// Axes of a frame in world coordinates: each +-x, +-y or +-z, all different; either handedness.
struct Frame {
  glm::dvec3 u;
  glm::dvec3 v;
  glm::dvec3 normal;
};

/// Axes of cubemap face 0 to 5, as CubemapView's table has them.
[[nodiscard]] const Frame& face_frame(int face) noexcept;

/// Unit direction of the point (column, row) of a cubemap face with `size` texels along an edge. Texel (i, j) has its
/// centre at (i + 0.5, j + 0.5).
[[nodiscard]] glm::dvec3 face_direction(int size, int face, double column, double row) noexcept;

/// Unit direction of the point (column, row) of a lat-long, counted in the same way. The same bits on every machine.
[[nodiscard]] glm::dvec3 lat_long_direction(int width, int height, double column, double row) noexcept;

/// Steradians of each texel in row `row` of a lat-long of `width` x `height`: all texels of a row are equal.
[[nodiscard]] double lat_long_texel_solid_angle(int width, int height, int row);

/// Writes the steradians of the texels in row `row` of a cubemap face to `row_angles` (`size` of them, the
/// face's edge). Relative error below 1e-11.
void cubemap_row_solid_angles(int row, std::span<double> row_angles);

}  // namespace welkin::image
