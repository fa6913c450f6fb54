// Directions as callers give them.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "welkin/error.h"

namespace welkin::sky {

/// The same direction at a length whose square neither overflows nor vanishes; one that is neither is left alone.
[[nodiscard]] inline glm::dvec3 of_moderate_length(const glm::dvec3& direction) noexcept {
  const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  if (largest > 1e-100 && largest < 1e100) return direction;
  return largest > 0.0 ? direction / largest : direction;
}

/// Towards a sun, of length 1. Throws `Error` (invalid_argument) for one that has no direction.
[[nodiscard]] inline glm::dvec3 sun_unit(const glm::dvec3& sun) {
  const glm::dvec3 moderate = of_moderate_length(sun);
  const double length = std::sqrt(glm::dot(moderate, moderate));
  if (length > 0.0 && std::isfinite(length)) return moderate / length;
  throw Error(ErrorCode::invalid_argument, "the sun's direction is (" + std::to_string(sun.x) + ", " +
                                               std::to_string(sun.y) + ", " + std::to_string(sun.z) +
                                               "); it must be finite and have a length, best 1");
}

}  // namespace welkin::sky
