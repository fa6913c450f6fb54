// Phase functions keep all light: their integral over the sphere is 1, for the sharpest lobes too.
#include "sky/phase_functions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/catch.h"

namespace welkin {
namespace {

/// Integral over the sphere of phase(c) c^power. The lobe's width in 1 - |c| is w = (1 - |g|)^2: places are even in the
/// logarithm of 1 - |c| + w.
template <class Phase>
double integral(double g, int power, const Phase& phase) {
  const double width = (1.0 - std::abs(g)) * (1.0 - std::abs(g));
  const double low = std::log(width);
  const double high = std::log(2.0 + width);
  constexpr int points = 20000;
  double sum = 0.0;
  for (int i = 0; i < points; ++i) {
    const double t = std::exp(low + (high - low) * (i + 0.5) / points);
    const double along = 1.0 - (t - width);
    const double cosine = g < 0.0 ? -along : along;
    sum += phase(cosine) * std::pow(cosine, power) * t;
  }
  return 2.0 * std::numbers::pi * sum * (high - low) / points;
}

}  // namespace

TEST_CASE("sky: phase functions integrate to 1 and have their mean cosine", "[sky][air]") {
  for (const double g : {-0.999, -0.9, -0.5, -1e-3, 0.0, 1e-3, 0.3, 0.8, 0.99, 0.999}) {
    INFO("g = " << g);
    const auto henyey = [g](double c) { return sky::henyey_greenstein_phase(g, c); };
    const auto cornette = [g](double c) { return sky::cornette_shanks_phase(g, c); };
    CHECK(integral(g, 0, henyey) == Approx(1.0).epsilon(1e-5));
    CHECK(integral(g, 1, henyey) == Approx(g).epsilon(1e-5).margin(1e-7));
    CHECK(integral(g, 0, cornette) == Approx(1.0).epsilon(1e-5));
    CHECK(integral(g, 1, cornette) ==
          Approx(3.0 * g * (4.0 + g * g) / (5.0 * (2.0 + g * g))).epsilon(1e-5).margin(1e-7));
  }
  CHECK(integral(0.0, 0, [](double c) { return sky::rayleigh_phase(c); }) == Approx(1.0).epsilon(1e-5));
}

TEST_CASE("sky: phase functions are mirror images for opposite g, and Rayleigh's is Cornette and Shanks's for 0",
          "[sky][air]") {
  for (int i = 0; i <= 200; ++i) {
    const double c = i / 100.0 - 1.0;
    CHECK(sky::cornette_shanks_phase(0.0, c) == Approx(sky::rayleigh_phase(c)).epsilon(1e-14));
    for (const double g : {0.2, 0.76, 0.999}) {
      CHECK(sky::cornette_shanks_phase(-g, -c) == sky::cornette_shanks_phase(g, c));
      CHECK(sky::henyey_greenstein_phase(-g, -c) == sky::henyey_greenstein_phase(g, c));
      const auto direct = static_cast<double>(
          (1.0L - static_cast<long double>(g) * g) / (4.0L * std::numbers::pi_v<long double>) /
          std::pow(1.0L + static_cast<long double>(g) * g - 2.0L * static_cast<long double>(g) * c, 1.5L));
      CHECK(sky::henyey_greenstein_phase(g, c) == Approx(direct).epsilon(1e-12));
      CHECK(sky::aerosol_phase(AerosolPhase::henyey_greenstein, g, c) == sky::henyey_greenstein_phase(g, c));
      CHECK(sky::aerosol_phase(AerosolPhase::cornette_shanks, g, c) == sky::cornette_shanks_phase(g, c));
    }
  }
  // Rounding may carry a cosine past 1.
  CHECK(std::isfinite(sky::henyey_greenstein_phase(0.999, 1.0 + 1e-15)));
  CHECK(std::isfinite(sky::henyey_greenstein_phase(-0.999, -1.0 - 1e-15)));
}

}  // namespace welkin
