// A sun's direction as what skies ask of it.
#pragma once

#include <glm/vec3.hpp>

namespace welkin::sky {

/// Relative to the vertical, azimuth counted from +z towards +x.
struct SunAngles {
  double zenith_cosine = 1.0;
  double zenith_sine = 0.0;
  double azimuth_cosine = 1.0;  ///< in the zenith as for azimuth 0
  double azimuth_sine = 0.0;
};

/// Of a direction of any length. Throws `Error` (invalid_argument) if it is not finite or has none.
[[nodiscard]] SunAngles sun_angles(const glm::dvec3& sun);

}  // namespace welkin::sky
