// The aerosol's phase function as quadratures need it.
#pragma once

#include "welkin/atmosphere.h"

namespace welkin::sky {

/// factor (1 + even nu^2) / (gap + slope x)^1.5, x = 1 - nu or, if it scatters backwards, 1 + nu.
struct AerosolLobe {
  double factor;
  double gap;    ///< (1 - |g|)^2
  double slope;  ///< 2 |g|
  double even;   ///< 1: Cornette-Shanks; 0: Henyey-Greenstein
  bool backwards;
};

[[nodiscard]] AerosolLobe aerosol_lobe(const Atmosphere& atmosphere) noexcept;

}  // namespace welkin::sky
