// A texel as numbers: its luminance, and whether it has one.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>

namespace welkin::projection {

/// Rec. 709 luminance of linear RGB.
[[nodiscard]] inline double luminance(const glm::dvec3& rgb) noexcept {
  return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

/// Whether all three channels are numbers.
[[nodiscard]] inline bool is_finite(const float* rgb) noexcept {
  return std::isfinite(rgb[0]) && std::isfinite(rgb[1]) && std::isfinite(rgb[2]);
}

/// A texel's RGB in double.
[[nodiscard]] inline glm::dvec3 radiance_of(const float* rgb) noexcept { return {rgb[0], rgb[1], rgb[2]}; }

}  // namespace welkin::projection
