#include "tools/clamped_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "image/geometry.h"

namespace welkin::tool {
namespace {

/// Sums of luminance.
struct Light {
  double all = 0.0;
  double beyond = 0.0;

  void add(const float* rgb, double solid_angle, const glm::dvec3& largest) {
    constexpr glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);
    const glm::dvec3 radiance = glm::max(glm::dvec3(rgb[0], rgb[1], rgb[2]), 0.0);
    all += solid_angle * glm::dot(radiance, kLuminance);
    beyond += solid_angle * glm::dot(glm::max(radiance - largest, 0.0), kLuminance);
  }
  [[nodiscard]] double share() const { return all > 0.0 ? beyond / all : 0.0; }
};

}  // namespace

double share_beyond(const LatLongView& picture, const glm::dvec3& largest) {
  Light light;
  const auto* rgb = static_cast<const float*>(picture.pixels);
  for (int row = 0; row < picture.height; ++row) {
    const double solid_angle = image::lat_long_texel_solid_angle(picture.width, picture.height, row);
    for (int column = 0; column < picture.width; ++column, rgb += 3) light.add(rgb, solid_angle, largest);
  }
  return light.share();
}

double share_beyond(const CubemapView& cubemap, const glm::dvec3& largest) {
  Light light;
  const double edge = 2.0 / cubemap.size;
  for (const void* const face : cubemap.faces) {
    const auto* rgb = static_cast<const float*>(face);
    for (int row = 0; row < cubemap.size; ++row) {
      const double v = (row + 0.5) * edge - 1.0;
      for (int column = 0; column < cubemap.size; ++column, rgb += 3) {
        const double u = (column + 0.5) * edge - 1.0;
        const double squared = 1.0 + u * u + v * v;
        light.add(rgb, 1.0 / (squared * std::sqrt(squared)), largest);  // but for a factor
      }
    }
  }
  return light.share();
}

}  // namespace welkin::tool
