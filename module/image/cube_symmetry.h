// The symmetries of a cube: mirror images and quarter turns that take texels of a cubemap to texels.
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "image/geometry.h"

namespace welkin::image {

// The 16 that keep the vertical axis. On a lat-long whose columns divide by four the images of a texel lie at the same
// positions within its texels, so that they share what depends on the position alone.

/// A mirror, x to -x; then quarter turns about y, from x towards z; then the other hemisphere, y to -y.
struct CubeImage {
  int quarter = 0;
  bool mirrored = false;
  bool below = false;
};

constexpr CubeImage cube_image_of(int index) noexcept { return {index / 4, (index & 2) != 0, (index & 1) != 0}; }

constexpr int index_of(const CubeImage& image) noexcept {
  return 4 * image.quarter + (image.mirrored ? 2 : 0) + (image.below ? 1 : 0);
}

/// Returns where an image has a point of the cube.
inline glm::ivec3 moved(const CubeImage& image, glm::ivec3 point) noexcept {
  if (image.mirrored) point.x = -point.x;
  for (int k = 0; k < image.quarter; ++k) point = {-point.z, point.y, point.x};
  if (image.below) point.y = -point.y;
  return point;
}

/// Returns the point that an image has here.
inline glm::ivec3 moved_back(const CubeImage& image, glm::ivec3 point) noexcept {
  if (image.below) point.y = -point.y;
  for (int k = 0; k < image.quarter; ++k) point = {point.z, point.y, -point.x};
  if (image.mirrored) point.x = -point.x;
  return point;
}

/// The position of a face's texels after a symmetry: in `face`, the one at (0, 0) at (column, row), those to its right
/// and below it by these steps.
struct FaceImage {
  int face;
  int column, row;
  int across_columns, across_rows;
  int down_columns, down_rows;
};

/// `image_of(texel)`: where the symmetry takes a texel.
template <class ImageOf>
FaceImage image_of_face(int face, const ImageOf& image_of) {
  const CubeTexel first = image_of(CubeTexel{face, 0, 0});
  const CubeTexel right = image_of(CubeTexel{face, 1, 0});
  const CubeTexel below = image_of(CubeTexel{face, 0, 1});
  return {first.face,
          first.column,
          first.row,
          right.column - first.column,
          right.row - first.row,
          below.column - first.column,
          below.row - first.row};
}

using WholeMatrix = glm::mat<3, 3, int>;

/// Returns the matrix in whole numbers if it is one of the cube's 48 symmetries: each entry within 1e-9 of 0, 1 or -1.
[[nodiscard]] inline std::optional<WholeMatrix> cube_symmetry_of(const glm::dmat3& rotation) noexcept {
  WholeMatrix result(0);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double whole = std::round(rotation[column][row]);
      if (!(std::abs(rotation[column][row] - whole) <= 1e-9)) return {};
      result[column][row] = static_cast<int>(whole);
    }
  }
  return result;
}

}  // namespace welkin::image
