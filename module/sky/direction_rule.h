// Directions at a height that light is summed over.
#pragma once

#include <array>

namespace welkin::sky {

/// Directions of the quadrature at a height: over the ground, between the horizon and the horizontal, and upwards, each
/// by Gauss and Legendre, closer together about the horizon.
struct DirectionRule {
  static constexpr int kGroundNodes = 8;
  static constexpr int kLowNodes = 8;
  static constexpr int kUpperNodes = 16;
  static constexpr int kZeniths = kGroundNodes + kLowNodes + kUpperNodes;
  static constexpr int kAzimuths = 16;  ///< over half the circle, at the middles of as many parts

  std::array<double, kZeniths> cosines{};
  std::array<double, kZeniths> weights{};  ///< of the cosine
};

/// `horizon`: cosine of the zenith angle of the horizon at that height, -1 to 0.
[[nodiscard]] DirectionRule direction_rule(double horizon);

}  // namespace welkin::sky
