// Directions and weights over a sky.
#pragma once

#include <vector>

#include "welkin/sky_harmonics.h"

namespace welkin::sky {

/// Rings of one side of the horizon. Weights: of the integral over the zenith's cosine.
struct RingRule {
  std::vector<double> cosines;
  std::vector<double> sines;
  std::vector<double> weights;
};

/// Azimuths in half the circle, each standing for its mirror image too: weights add up to 2 pi.
struct AzimuthRule {
  std::vector<double> cosines;
  std::vector<double> from_sun;       ///< 1 - cosine, with its digits
  std::vector<double> from_opposite;  ///< 1 + cosine
  std::vector<double> weights;
};

/// How a quadrature cuts the sphere.
struct SkyRule {
  RingRule above;  ///< the horizon
  RingRule below;
  AzimuthRule azimuths;
};

/// `horizon`: cosine of its zenith angle. `top`: that of the highest ring that has any light: 1 inside the air, from
/// space its upper edge. `asymmetry`: the aerosol's g. Throws `Error` (invalid_argument) for options out of range.
[[nodiscard]] SkyRule sky_rule(const SkyHarmonicsOptions& options, double horizon, double top, double asymmetry);

}  // namespace welkin::sky
