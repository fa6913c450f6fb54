#include "sky/check_sky_arguments.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "welkin/error.h"

namespace welkin::sky {

void check_altitude(double altitude_m) {
  if (altitude_m >= 0.0 && altitude_m <= kHighestAltitude) return;
  std::ostringstream message;
  message << "the altitude is " << altitude_m << " m; it must be from 0 (the ground) to " << kHighestAltitude;
  throw Error(ErrorCode::invalid_argument, message.str());
}

void check_direction(const char* what, const glm::dvec3& direction) {
  if (std::abs(glm::length(direction) - 1.0) <= 1e-6) return;
  std::ostringstream message;
  message << what << " is (" << direction.x << ", " << direction.y << ", " << direction.z
          << "); it must be of length 1 (normalise it)";
  throw Error(ErrorCode::invalid_argument, message.str());
}

}  // namespace welkin::sky
