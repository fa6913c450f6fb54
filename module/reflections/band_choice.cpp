#include "reflections/band_choice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "math/elementary.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kStep = 1.0 / 3.0;  ///< of a bound, from one tightening to the next
constexpr double kTaper = 0.2;

// Envelopes of errors over the images in docs/maths/reflections.md, by `reach`: the largest error at a texel is below
// kOfMaximum e^-reach, most root mean square errors with their safety are below kOfRms e^-reach.
constexpr double kOfMaximum = 17.3;
constexpr double kOfRms = 0.88;
constexpr double kMinReach = 2.0;

// The kink's error at the dark side of an edge falls like bands^-2.7.
constexpr double kKinkBands = 56.0;  ///< at a largest error of 1e-2
constexpr double kKinkPower = 1.0 / 2.7;
constexpr double kMinKinkBands = 20.0;  // fewer hide checkers of few texels from the estimate
constexpr double kMaxKinkBands = 512.0;
constexpr double kOfDark = 1.8;  ///< times that, where an image has dark parts

// The loss of rings of height h falls like h^4 (`RingShares`): a bound that is looser by a factor takes fewer by its
// fourth root. A step that fails for a few rings takes a second transform: rings of
// tighter bounds than the default's grow with the cube root.
constexpr double kRingsOfMaximum = 5.7;  ///< times 1 / alpha, at a largest error of 1e-2
constexpr double kRingsOfRms = 5.7;      ///< the same at a root mean square error of 1e-3
constexpr double kMinRingsOfAlpha = 3.4;
constexpr double kMinRings = 128.0;  ///< at the default bounds; they grow with the fourth root as well

// Faces that are halved to texels of h = 2 / size lose an amount that falls like h^4 too.
constexpr double kHalvedTexel = 0.6;          // times alpha, at a root mean square error of 1e-3
constexpr double kHalvedPower = 1.0 / 3.0;    // of the bound
constexpr double kMaxHalvedTexel = 1.75;      // times alpha
constexpr double kTexelsOfBands = 2.0 / 3.0;  // at least

double fourth_root(double x) noexcept { return std::sqrt(std::sqrt(x)); }

}  // namespace

ErrorBounds ErrorBounds::tightened(int steps) const noexcept {
  ErrorBounds tighter = *this;
  for (int k = 0; k < steps; ++k) tighter = {tighter.rms * kStep, tighter.maximum * kStep};
  return tighter;
}

double reach_within(const ErrorBounds& bounds) noexcept {
  const double ratio = std::max(kOfMaximum / bounds.maximum, kOfRms / bounds.rms);
  return std::max(kMinReach, math::logarithm(ratio));
}

namespace {

int whole_bands(double bands) noexcept { return static_cast<int>(std::ceil(bands / kBandStep)) * kBandStep; }

/// For the kink of wide lobes.
double bands_of_kink(const ErrorBounds& bounds) noexcept {
  const double tighter = math::exponential(kKinkPower * math::logarithm(1e-2 / bounds.maximum));
  return std::clamp(kKinkBands * tighter, kMinKinkBands, kMaxKinkBands);
}

/// For the peak. The lobe's poles are at sin^2(theta / 2) = -alpha^2 / (1 - alpha^2), theta = +-2 i alpha for small
/// alpha. P_l grows like exp(l |Im theta|) there, so the spectrum of a function that is analytic up to them falls like
/// exp(-2 alpha l).
double bands_of_reach(double alpha, const ErrorBounds& bounds) noexcept {
  return std::min(1e6, reach_within(bounds) / (2.0 * alpha));
}

}  // namespace

int bands_within(double alpha, const ErrorBounds& bounds) noexcept {
  return whole_bands(std::max(bands_of_reach(alpha, bounds), bands_of_kink(bounds)));
}

int first_bands_within(double alpha, const ErrorBounds& bounds) noexcept {
  return whole_bands(std::max(bands_of_reach(alpha, bounds), std::min(kKinkBands, bands_of_kink(bounds))));
}

int bands_for_dark(const ErrorBounds& bounds) noexcept { return whole_bands(kOfDark * bands_of_kink(bounds)); }

int first_bands_for_dark(const ErrorBounds& bounds) noexcept {
  return std::min(bands_for_dark(bounds), static_cast<int>(kKinkBands));
}

double rings_within(double alpha, const ErrorBounds& bounds) noexcept {
  const auto times = [](double tighter) {
    return tighter > 1.0 ? math::exponential(math::logarithm(tighter) / 3.0) : fourth_root(tighter);
  };
  const double of_alpha = std::max(
      {kRingsOfMaximum * times(1e-2 / bounds.maximum), kRingsOfRms * times(1e-3 / bounds.rms), kMinRingsOfAlpha});
  const double looser = std::max(1.0, std::min(bounds.rms / 1e-3, bounds.maximum / 1e-2));
  return std::max(kMinRings / fourth_root(looser), of_alpha / alpha);
}

double face_texels_within(double alpha, int bands, const ErrorBounds& bounds) noexcept {
  const double looser = math::logarithm(std::min(bounds.rms / 1e-3, bounds.maximum / 1e-2));
  const double texel = std::min(kMaxHalvedTexel, kHalvedTexel * math::exponential(kHalvedPower * looser));
  // h = 2 / size. A great circle crosses four faces, so kTexelsOfBands makes at least 8/3 texels per wave of the last
  // band.
  return std::max(2.0 / (texel * alpha), kTexelsOfBands * bands);
}

double taper(int l, int bands) noexcept {
  const double from = bands * (1.0 - kTaper);
  if (l <= from) return 1.0;
  const double share = (l - from) / (bands - from);
  return 0.5 + 0.5 * math::sine_cosine_of_turns(0.5 * share).cosine;
}

BandChoice tapered_lobe(double alpha, int bands) {
  BandChoice choice{lobe_spectrum(alpha, bands)};
  for (int l = 0; l < bands; ++l) choice.zonal[static_cast<std::size_t>(l)] *= taper(l, bands);
  return choice;
}

}  // namespace welkin::reflections
