// The sixteen mirror images and quarter turns of a cube that keep its vertical axis.
#pragma once

#include <glm/vec3.hpp>

#include "reflections/ring_kernels.h"

namespace welkin::reflections {

/// A mirror, then quarter turns, then the other hemisphere.
struct CubeImage {
  int quarter;
  bool mirrored;
  bool below;
};

constexpr CubeImage cube_image_of(int index) noexcept { return {index / 4, (index & 2) != 0, (index & 1) != 0}; }

constexpr int index_of(const CubeImage& image) noexcept {
  return 4 * image.quarter + (image.mirrored ? 2 : 0) + (image.below ? 1 : 0);
}

/// Where an image has a point of the cube.
inline glm::ivec3 moved(const CubeImage& image, glm::ivec3 point) noexcept {
  if (image.mirrored) point.x = -point.x;
  for (int k = 0; k < image.quarter; ++k) point = {-point.z, point.y, point.x};
  if (image.below) point.y = -point.y;
  return point;
}

/// Which point an image has here.
inline glm::ivec3 moved_back(const CubeImage& image, glm::ivec3 point) noexcept {
  if (image.below) point.y = -point.y;
  for (int k = 0; k < image.quarter; ++k) point = {point.z, point.y, -point.x};
  if (image.mirrored) point.x = -point.x;
  return point;
}

/// Whether a texel's centre lies in the sixteenth that is kept of all images: from -Z's middle towards +x and up to +Y.
/// In half texels, `image::point_of`, of the faces 5 and 2 only.
constexpr bool in_sixteenth(int face, const glm::ivec3& point) noexcept {
  return point.x >= 0 && point.y >= 0 && (face != 2 || (point.z <= 0 && point.x <= -point.z));
}

}  // namespace welkin::reflections
