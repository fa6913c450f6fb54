#include "sky/aerosol_lobe.h"

#include <cmath>

namespace welkin::sky {

AerosolLobe aerosol_lobe(const Atmosphere& atmosphere) noexcept {
  constexpr double quarter_over_pi = 0.07957747154594767;  // 1 / (4 pi)
  const double g = atmosphere.aerosol_asymmetry;
  const bool cornette = atmosphere.aerosol_phase == AerosolPhase::cornette_shanks;
  AerosolLobe lobe{};
  lobe.factor = quarter_over_pi * (1.0 - g * g) * (cornette ? 1.5 / (2.0 + g * g) : 1.0);
  lobe.gap = (1.0 - std::abs(g)) * (1.0 - std::abs(g));
  lobe.slope = 2.0 * std::abs(g);
  lobe.even = cornette ? 1.0 : 0.0;
  lobe.backwards = g < 0.0;
  return lobe;
}

}  // namespace welkin::sky
