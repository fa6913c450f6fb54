// Environments whose radiance is a function of direction.
#pragma once

#include <cmath>
#include <functional>
#include <glm/vec3.hpp>
#include <numbers>

#include "welkin/image.h"

namespace welkin::test {

/// A lat-long whose texels hold the function at their centres.
inline LatLongImage lat_long_of(int width, int height, const std::function<glm::dvec3(const glm::dvec3&)>& radiance) {
  LatLongImage image{width, height, {}};
  for (int row = 0; row < height; ++row) {
    const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / height);
    for (int column = 0; column < width; ++column) {
      const double longitude = std::numbers::pi * (1.0 - 2.0 * (column + 0.5) / width);
      const glm::dvec3 value = radiance(
          {std::sin(longitude) * std::cos(latitude), std::sin(latitude), std::cos(longitude) * std::cos(latitude)});
      for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(value[c]));
    }
  }
  return image;
}

}  // namespace welkin::test
