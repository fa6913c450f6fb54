// What places and directions of skies must be.
#pragma once

#include <glm/vec3.hpp>

namespace welkin::sky {

inline constexpr double kHighestAltitude = 1e9;  // m

/// Throw `Error` (invalid_argument), by the argument's name.
void check_altitude(double altitude_m);
void check_direction(const char* what, const glm::dvec3& direction);

}  // namespace welkin::sky
