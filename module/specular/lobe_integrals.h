// The prefilter's integral, direction by direction, in double.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "specular/clean_source.h"
#include "welkin/control.h"

namespace welkin::specular {

/// Int L k / Int k at unit directions, over all texels as areas. `alpha` above 0.
[[nodiscard]] std::vector<glm::dvec3> integrate_lobes(const CleanSource& source, double alpha,
                                                      std::span<const glm::dvec3> directions, const Control& control);

/// The radiance of the texel that a unit direction lies in: the limit for roughness 0.
[[nodiscard]] glm::dvec3 radiance_towards(const CleanSource& source, const glm::dvec3& direction) noexcept;

}  // namespace welkin::specular
