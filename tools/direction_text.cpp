#include "tools/direction_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/number_text.h"

namespace welkin::tool {
namespace {

std::string degrees(double radians) { return significant(std::abs(radians) * 180.0 / std::numbers::pi, 4); }

}  // namespace

std::string direction_text(const glm::dvec3& unit, bool z_is_up) {
  const double elevation = std::asin(std::clamp(z_is_up ? unit.z : unit.y, -1.0, 1.0));
  const double azimuth = z_is_up ? std::atan2(unit.y, unit.x) : std::atan2(unit.x, unit.z);
  const std::string sign = azimuth < 0.0 ? "-" : "+";
  return '(' + significant(unit.x, 4) + ", " + significant(unit.y, 4) + ", " + significant(unit.z, 4) +
         "): " + degrees(elevation) + " degrees " + (elevation < 0.0 ? "down" : "up") + ", " + degrees(azimuth) +
         " degrees from " + (z_is_up ? "+x towards " + sign + "y" : "+z towards " + sign + "x");
}

const char* face_name(int face) noexcept {
  constexpr std::array<const char*, 6> kNames = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
  return kNames.at(static_cast<std::size_t>(face));
}

}  // namespace welkin::tool
