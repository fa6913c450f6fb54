// What the prefilter's spectral method does to an environment, from the energy that it has in each band.
#pragma once

#include <span>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/prefilter_plan.h"
#include "transform/spectrum.h"

namespace welkin::budget {

/// The energy of each band: |c_l|^2 over orders and channels, so that their sum is Int |L|^2.
[[nodiscard]] std::vector<double> band_energies(const transforms::Spectrum& spectrum);

/// That of the difference of two spectra, over the bands that both have.
[[nodiscard]] std::vector<double> difference_energies(const transforms::Spectrum& a, const transforms::Spectrum& b);

/// An environment as the prefilter sees it.
struct EnvironmentEnergies {
  transforms::Spectrum spectrum;  ///< of all of it
  std::vector<double> whole;
  std::vector<double> rest;   ///< without the texels that the prefilter extracts and blurs exactly
  std::vector<double> rings;  ///< of what the rings lose that a cubemap goes through, at least; empty for a lat-long
};

/// `plan` says how narrow lobes get. Throws `Error` (cancelled).
[[nodiscard]] EnvironmentEnergies analyse_energies(const projection::SanitizedSource& source,
                                                   const reflections::PrefilterPlan& plan, int bands,
                                                   const Control& control);

/// Predicted rms error of a spectral mip relative to its own rms.
[[nodiscard]] double spectral_mip_error(const reflections::MipPlan& mip, const EnvironmentEnergies& energies);

/// Root mean square of what energies leave after a lobe: sqrt(sum k_l^2 S_l / 4 pi).
[[nodiscard]] double blurred_rms(double alpha, std::span<const double> energies);

}  // namespace welkin::budget
