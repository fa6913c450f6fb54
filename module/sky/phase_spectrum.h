// Phase functions as sums of Legendre polynomials.
#pragma once

#include <vector>

#include "welkin/atmosphere.h"

namespace welkin::sky {

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

}  // namespace welkin::sky
