#include "image/cube_texels.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "image/texel_geometry.h"

namespace welkin::image {
namespace {

struct WholeFrame {
  glm::ivec3 u;
  glm::ivec3 v;
  glm::ivec3 normal;
};

const WholeFrame& whole_frame(int face) {
  static const std::array<WholeFrame, 6> frames = [] {
    std::array<WholeFrame, 6> result{};
    for (int i = 0; i < 6; ++i) {
      const Frame& frame = face_frame(i);
      result[static_cast<std::size_t>(i)] = {glm::ivec3(frame.u), glm::ivec3(frame.v), glm::ivec3(frame.normal)};
    }
    return result;
  }();
  return frames[static_cast<std::size_t>(face)];
}

int dot(const glm::ivec3& a, const glm::ivec3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

}  // namespace

int face_of(const glm::dvec3& direction) noexcept {
  const double x = std::abs(direction.x);
  const double y = std::abs(direction.y);
  const double z = std::abs(direction.z);
  if (x >= y && x >= z) return direction.x < 0.0 ? 1 : 0;
  if (y >= z) return direction.y < 0.0 ? 3 : 2;
  return direction.z < 0.0 ? 5 : 4;
}

glm::ivec3 point_of(int size, const CubeTexel& texel) noexcept {
  const WholeFrame& frame = whole_frame(texel.face);
  return frame.normal * size + frame.u * (2 * texel.column + 1 - size) + frame.v * (2 * texel.row + 1 - size);
}

CubeTexel texel_at(int size, const glm::ivec3& point) noexcept {
  int face = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(point[axis]) == size) face = 2 * axis + (point[axis] < 0 ? 1 : 0);
  }
  const WholeFrame& frame = whole_frame(face);
  return {face, (dot(point, frame.u) + size - 1) / 2, (dot(point, frame.v) + size - 1) / 2};
}

// The point lies half a texel beyond the edge, on the face's plane: folded over the edge it lies half a texel down the
// neighbour.
CubeTexel across_edge(int size, const CubeTexel& outside) noexcept {
  const WholeFrame& frame = whole_frame(outside.face);
  glm::ivec3 point = point_of(size, outside);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(point[axis]) > size) {
      point[axis] = point[axis] < 0 ? -size : size;
    } else if (frame.normal[axis] != 0) {
      point[axis] -= frame.normal[axis];
    }
  }
  return texel_at(size, point);
}

}  // namespace welkin::image
