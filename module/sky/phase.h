// Phase functions: the share of scattered light that goes where, per steradian; their integral over the sphere is 1.
//
// `cosine` is of the angle by which light turns: 1 straight on. Only + - * / and square roots: the same bits
// everywhere.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "welkin/atmosphere.h"

namespace welkin::sky {

/// Of molecules, without their small anisotropy.
[[nodiscard]] inline double rayleigh_phase(double cosine) noexcept {
  return 3.0 / (16.0 * std::numbers::pi) * (1.0 + cosine * cosine);
}

/// (1 + g^2 - 2 g cosine)^(3/2) without the cancellation at g cosine = 1: the square of a difference and a product,
/// neither negative.
[[nodiscard]] inline double henyey_greenstein_denominator(double g, double cosine) noexcept {
  const double ahead = g < 0.0 ? 1.0 + cosine : 1.0 - cosine;
  const double size = g < 0.0 ? -g : g;
  const double square = (1.0 - size) * (1.0 - size) + 2.0 * size * (ahead > 0.0 ? ahead : 0.0);
  return square * std::sqrt(square);
}

/// Henyey and Greenstein 1941. The mean cosine is g.
[[nodiscard]] inline double henyey_greenstein_phase(double g, double cosine) noexcept {
  return (1.0 - g * g) / (4.0 * std::numbers::pi * henyey_greenstein_denominator(g, cosine));
}

/// Cornette and Shanks 1992, equation 8. Rayleigh's for g = 0; the mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)).
[[nodiscard]] inline double cornette_shanks_phase(double g, double cosine) noexcept {
  return 3.0 / (8.0 * std::numbers::pi) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + cosine * cosine) /
         henyey_greenstein_denominator(g, cosine);
}

[[nodiscard]] inline double aerosol_phase(AerosolPhase phase, double g, double cosine) noexcept {
  return phase == AerosolPhase::cornette_shanks ? cornette_shanks_phase(g, cosine) : henyey_greenstein_phase(g, cosine);
}

// Phase functions as sums of Legendre polynomials.

inline constexpr int kMostSourceBands = 20;

/// Moments chi_l of phase functions, p(cosine) = sum over l of (2 l + 1) / (4 pi) chi_l P_l(cosine), chi_0 = 1.
struct PhaseSpectrum {
  std::vector<double> rayleigh;  ///< 1, 0, 1/10
  std::vector<double> aerosol;   ///< as many as bands
  int bands = 3;
};

/// chi_0 to chi_(bands - 1) of an air's aerosol: g^l for Henyey-Greenstein. Cornette-Shanks' are those of
/// 3/2 (1 + cosine^2) / (2 + g^2) times it, cosine P_l = ((l + 1) P_(l + 1) + l P_(l - 1)) / (2 l + 1) being applied
/// twice.
[[nodiscard]] std::vector<double> aerosol_moments(const Atmosphere& atmosphere, int bands);

/// As many bands as an air's aerosol needs for what it leaves out to be below 1 % of its last moment, up to 20.
/// Narrower lobes (|g| above 0.79) lose detail finer than 9 degrees: their moments fade towards the end, that the cut
/// shows less.
[[nodiscard]] PhaseSpectrum phase_spectrum(const Atmosphere& atmosphere);

/// A phase function of these moments, not below 0.
[[nodiscard]] double phase_of(const std::vector<double>& moments, double cosine) noexcept;

// The aerosol's phase function as quadratures need it.

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
