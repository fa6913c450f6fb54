// Where the texels of a cubemap's faces look: the table of `welkin::CubemapView`.
#pragma once

#include <welkin/core.h>

#include <glm/geometric.hpp>

namespace cube_frames {

/// The unit direction of the centre of a texel. Faces are +X -X +Y -Y +Z -Z, rows from the top, of `size` texels.
inline welkin::dvec3 direction_of(int face, int column, int row, int size) {
  const double u = (2.0 * column + 1.0) / size - 1.0;
  const double v = (2.0 * row + 1.0) / size - 1.0;
  switch (face) {
    case 0: return glm::normalize(welkin::dvec3(1.0, -v, -u));
    case 1: return glm::normalize(welkin::dvec3(-1.0, -v, u));
    case 2: return glm::normalize(welkin::dvec3(u, 1.0, v));
    case 3: return glm::normalize(welkin::dvec3(u, -1.0, -v));
    case 4: return glm::normalize(welkin::dvec3(u, -v, 1.0));
    default: return glm::normalize(welkin::dvec3(-u, -v, -1.0));
  }
}

}  // namespace cube_frames
