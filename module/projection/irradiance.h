// Directions that cover the sphere evenly.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace welkin::projection {

/// Points of equal area on a Fibonacci spiral: equal steps in height, each turned by the golden angle from the one
/// before. The same bits on every machine. Throws `Error` (invalid_argument) unless 1 <= count <= 100 000.
[[nodiscard]] std::vector<glm::dvec3> spiral(int count);

}  // namespace welkin::projection
