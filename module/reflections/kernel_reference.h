// The integral of an environment over a kernel, direction by direction, in double.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/lobe.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Int L k / Int k at unit directions, over all texels as areas. Relative error below 1e-5 for continuous kernels.
[[nodiscard]] std::vector<glm::dvec3> integrate_kernel(const projection::SanitizedSource& source, const Lobe& kernel,
                                                       std::span<const glm::dvec3> directions, const Control& control);

}  // namespace welkin::reflections
