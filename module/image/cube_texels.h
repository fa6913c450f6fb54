// A cube's texels as points with whole coordinates: where a texel goes when the cube turns, and what lies beyond a
// face's edge, without rounding.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace welkin::image {

struct CubeTexel {
  int face = 0;
  int column = 0;
  int row = 0;
};

/// The face on which a direction lies: that of its longest component, of equal ones the first of x, y, z.
[[nodiscard]] int face_of(const glm::dvec3& direction) noexcept;

/// A texel's centre in half texels: a cube with `size` texels along an edge reaches from -size to size.
[[nodiscard]] glm::ivec3 point_of(int size, const CubeTexel& texel) noexcept;

/// The texel of that centre. One component, `size` in magnitude, tells the face; the others are smaller.
[[nodiscard]] CubeTexel texel_at(int size, const glm::ivec3& point) noexcept;

/// The texel that shares an edge with the outermost one. Either the column or the row is -1 or `size`, not both.
[[nodiscard]] CubeTexel across_edge(int size, const CubeTexel& outside) noexcept;

}  // namespace welkin::image
