#include "sky/phase.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "math/elementary.h"

namespace welkin::sky {
namespace {

constexpr double kSmallestMoment = 0.01;

/// Moments of the cosine times a function of moments chi, of which one is lost:
/// (2 l + 1) x P_l = (l + 1) P_(l+1) + l P_(l-1).
std::vector<double> times_cosine(const std::vector<double>& chi) {
  std::vector<double> moments(chi.size() - 1);
  for (std::size_t l = 0; l < moments.size(); ++l) {
    const auto degree = static_cast<double>(l);
    moments[l] = ((degree + 1.0) * chi[l + 1] + (l > 0 ? degree * chi[l - 1] : 0.0)) / (2.0 * degree + 1.0);
  }
  return moments;
}

}  // namespace

std::vector<double> aerosol_moments(const Atmosphere& atmosphere, int bands) {
  std::vector<double> chi(static_cast<std::size_t>(bands) + 2);
  double power = 1.0;
  for (double& moment : chi) {
    moment = power;  // Henyey-Greenstein: g^l
    power *= atmosphere.aerosol_asymmetry;
  }
  if (atmosphere.aerosol_phase == AerosolPhase::cornette_shanks) {
    const std::vector<double> squared = times_cosine(times_cosine(chi));
    const double whole = chi[0] + squared[0];
    for (std::size_t l = 0; l < squared.size(); ++l) chi[l] = (chi[l] + squared[l]) / whole;
  }
  chi.resize(static_cast<std::size_t>(bands));
  return chi;
}

PhaseSpectrum phase_spectrum(const Atmosphere& atmosphere) {
  PhaseSpectrum spectrum;
  spectrum.aerosol = aerosol_moments(atmosphere, kMostSourceBands + 1);
  const double left_out = std::abs(spectrum.aerosol.back());
  spectrum.bands = 3;
  while (spectrum.bands < kMostSourceBands &&
         std::abs(spectrum.aerosol[static_cast<std::size_t>(spectrum.bands)]) > kSmallestMoment) {
    ++spectrum.bands;
  }
  if (atmosphere.aerosol.density.empty() || atmosphere.aerosol.scattering_per_m.empty()) spectrum.bands = 3;
  spectrum.aerosol.resize(static_cast<std::size_t>(spectrum.bands));
  if (spectrum.bands == kMostSourceBands && left_out > kSmallestMoment) {
    for (int l = 0; l < spectrum.bands; ++l) {
      const double cosine = math::sine_cosine_of_turns(0.25 * l / spectrum.bands).cosine;
      spectrum.aerosol[static_cast<std::size_t>(l)] *= 1.0 - left_out * (1.0 - cosine * cosine);
    }
  }
  spectrum.rayleigh.assign(static_cast<std::size_t>(spectrum.bands), 0.0);
  spectrum.rayleigh[0] = 1.0;
  spectrum.rayleigh[2] = 0.1;
  return spectrum;
}

double phase_of(const std::vector<double>& moments, double cosine) noexcept {
  double before = 0.0;
  double here = 1.0;
  double sum = 0.0;
  for (std::size_t l = 0; l < moments.size(); ++l) {
    const auto degree = static_cast<double>(l);
    sum += (2.0 * degree + 1.0) * moments[l] * here;
    const double next = ((2.0 * degree + 1.0) * cosine * here - degree * before) / (degree + 1.0);
    before = here;
    here = next;
  }
  return std::max(0.0, sum / (4.0 * std::numbers::pi));
}

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
