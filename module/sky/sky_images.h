// The sun's disc in images of a sky.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "image/geometry.h"

namespace welkin::sky {

/// The part of a disc that can be seen: within an angle of its centre and above the horizon.
struct VisibleDisc {
  glm::dvec3 centre{};       ///< unit
  double radius_sine = 0.0;  ///< of the angular radius, at most 10 degrees; 0: a point
  double radius_cosine = 1.0;
  double horizon_cosine = -1.0;  ///< with the zenith; below it the ground is in the way
};

/// A texel that the disc covers in part or whole.
struct CoveredTexel {
  std::size_t texel = 0;    ///< as `image::TexelGrid` counts
  double steradians = 0.0;  ///< of the disc
};

/// Returns the covered texels, rising. Areas are right to 1e-3 of the disc's. If the disc is a point, or smaller than
/// can be resolved: the texel in which its highest point lies, with 1.
[[nodiscard]] std::vector<CoveredTexel> covered_texels(const VisibleDisc& disc, const image::TexelGrid& grid);

}  // namespace welkin::sky
