#include "specular/band_choice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "specular/lobe.h"
#include "tables/logarithm.h"
#include "tables/trigonometry.h"

namespace welkin::specular {
namespace {

constexpr double kTaper = 0.2;
constexpr double kReach = 9.25;    ///< for rms 1e-3 and maximum 1e-2: docs/reflections.md has what was measured
constexpr int kLeastBands = 96;    ///< wide lobes: their kink at the horizon, not their peak, asks for bands
constexpr int kMostForKink = 512;  ///< where the bounds are tight
constexpr int kStep = 8;           ///< bands are a multiple of it

/// 1 up to the taper, then half a cosine down to 0 at `bands`.
double taper(int l, int bands) {
  const double from = bands * (1.0 - kTaper);
  if (l <= from) return 1.0;
  const double share = (l - from) / (bands - from);
  return 0.5 + 0.5 * tables::sine_cosine_of_turns(0.5 * share).cosine;
}

}  // namespace

/// What the kink leaves falls with the bands; four more in `reach` are a fiftieth of the error.
int bands_for(double alpha, double reach) noexcept {
  const double kink = std::clamp(kLeastBands * (1.0 + (reach - kReach)), 32.0, 1.0 * kMostForKink);
  const double bands = std::max(std::min(1e6, reach / (2.0 * alpha)), kink);
  return static_cast<int>(std::ceil(bands / kStep)) * kStep;
}

BandChoice choose_bands(double alpha, double reach, int most) {
  BandChoice choice;
  const int bands = std::min(most, bands_for(alpha, reach));
  choice.zonal = lobe_spectrum(alpha, bands);
  // Sum (2 l + 1) k_l / k_0 over all bands is the peak over the mean.
  const double whole = 4.0 * std::numbers::pi * lobe(1.0, alpha) / lobe_integral(alpha);
  double kept = 0.0;
  for (int l = 0; l < bands; ++l) {
    double& factor = choice.zonal[static_cast<std::size_t>(l)];
    factor *= taper(l, bands);
    kept += (2.0 * l + 1.0) * factor;
  }
  choice.loss_at_peak = std::abs(whole - kept) / whole;
  return choice;
}

double reach_for(double rms_error, double maximum_error) noexcept {
  const double stricter = std::min(rms_error / 1e-3, maximum_error / 1e-2);
  return std::max(2.0, kReach - tables::logarithm(std::clamp(stricter, 1e-6, 1e3)));
}

}  // namespace welkin::specular
