#include "sky/sun_angles.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "welkin/error.h"

namespace welkin::sky {

SunAngles sun_angles(const glm::dvec3& sun) {
  const double largest = std::max({std::abs(sun.x), std::abs(sun.y), std::abs(sun.z)});
  const bool finite = std::isfinite(sun.x) && std::isfinite(sun.y) && std::isfinite(sun.z);
  if (!finite || !(largest > 0.0)) {
    throw Error(ErrorCode::invalid_argument, "the sun's direction (" + std::to_string(sun.x) + " " +
                                                 std::to_string(sun.y) + " " + std::to_string(sun.z) +
                                                 ") has no length that could be made 1; (0 1 0) is the zenith");
  }
  const double x = sun.x / largest;  // no square overflows or vanishes
  const double y = sun.y / largest;
  const double z = sun.z / largest;
  const double across = std::sqrt(x * x + z * z);
  const double length = std::sqrt(across * across + y * y);
  SunAngles angles{.zenith_cosine = y / length, .zenith_sine = across / length};
  if (across > 0.0) {
    angles.azimuth_cosine = z / across;
    angles.azimuth_sine = x / across;
  }
  return angles;
}

}  // namespace welkin::sky
