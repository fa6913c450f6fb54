#include "math/direction.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <string>

#include "platform/text.h"

namespace welkin::math {

dvec3 rescaled_direction(const dvec3& direction, const char* what) {
  const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  const bool finite = std::isfinite(direction.x) && std::isfinite(direction.y) && std::isfinite(direction.z);
  if (finite && largest > 0.0) return direction / largest;
  throw Error(ErrorCode::invalid_argument, std::string(what) + " is (" + platform::number_text(direction.x) + ", " +
                                               platform::number_text(direction.y) + ", " +
                                               platform::number_text(direction.z) +
                                               "); it must be finite and not zero, of any length");
}

dvec3 unit_direction(const dvec3& direction, const char* what) {
  const dvec3 moderate = moderate_direction(direction, what);
  return moderate / glm::length(moderate);
}

std::vector<dvec3> unit_directions(std::span<const dvec3> directions, const char* what) {
  std::vector<dvec3> units;
  units.reserve(directions.size());
  for (const dvec3& direction : directions) {
    const std::string name = std::string(what) + ' ' + std::to_string(units.size());
    units.push_back(unit_direction(direction, name.c_str()));
  }
  return units;
}

}  // namespace welkin::math
