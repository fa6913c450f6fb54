// How much of an environment's light lies beyond what a file's format holds.
#pragma once

#include <glm/vec3.hpp>

#include "welkin/image.h"

namespace welkin::tool {

/// Returns the light that a clamp at `largest` takes away as a share of all luminance, by solid angle; 0 if there is no
/// light. Pixels are RGB floats; negative values count as no light.
[[nodiscard]] double share_beyond(const LatLongView& picture, const glm::dvec3& largest);
[[nodiscard]] double share_beyond(const CubemapView& cubemap, const glm::dvec3& largest);

}  // namespace welkin::tool
