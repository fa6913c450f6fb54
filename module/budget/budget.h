// What all choices share.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/bright_lights.h"
#include "reflections/bright_texels.h"
#include "reflections/prefilter_plan.h"
#include "transform/spectrum.h"
#include "welkin/error_budget.h"

namespace welkin::budget {

/// Throws `Error` (invalid_argument).
void check_budget(const ErrorBudget& budget);

/// |a - b| / |b| over all coefficients and channels; 0 if both are black, infinite if b alone is. The same bands.
[[nodiscard]] double relative_difference(const SphericalHarmonics& a, const SphericalHarmonics& b);

/// Fills in what follows from `choice.tried`: the cheapest under the budget, or else the one of the least error.
template <class Setting>
void settle(BudgetChoice<Setting>& choice, const ErrorBudget& budget) {
  const EstimatedSetting<Setting>* best = nullptr;
  for (const EstimatedSetting<Setting>& entry : choice.tried) {
    const bool under = entry.error_estimate <= budget.relative;
    const bool better = best == nullptr || (under && !choice.met) ||
                        (under == choice.met && (under ? entry.predicted_nanoseconds < best->predicted_nanoseconds
                                                       : entry.error_estimate < best->error_estimate));
    if (!better) continue;
    best = &entry;
    choice.met = under;
  }
  if (best == nullptr) return;
  choice.setting = best->setting;
  choice.error_estimate = best->error_estimate;
  choice.predicted_nanoseconds = best->predicted_nanoseconds;
}

// What an environment has beyond its first bands.

/// `radiance`: the first bands of the same pixels. Reads every pixel once. Throws `Error` as `project`.
[[nodiscard]] HighBands high_bands(const CubemapView& view, const SphericalHarmonics& radiance,
                                   const PixelPolicy& pixels, const Control& control);
[[nodiscard]] HighBands high_bands(const LatLongView& view, const SphericalHarmonics& radiance,
                                   const PixelPolicy& pixels, const Control& control);

// What the prefilter's spectral method does to an environment, from the energy that it has in each band.

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
  std::vector<double> rings_of_rest;             ///< the same without those texels
  std::vector<reflections::BrightTexel> bright;  ///< those texels
  reflections::PictureShape shape;
};

/// `plan` says how narrow lobes get. Throws `Error` (cancelled).
[[nodiscard]] EnvironmentEnergies analyse_energies(const projection::SanitizedSource& source,
                                                   const reflections::PrefilterPlan& plan, int bands,
                                                   const Control& control);

/// Predicted rms error of a spectral mip relative to its own rms. `lights`: the bright texels as the mip's own plan has
/// them, for looser bounds merge more of them.
[[nodiscard]] double spectral_mip_error(const reflections::MipPlan& mip, const EnvironmentEnergies& energies,
                                        const reflections::BrightLights& lights);

/// Root mean square of what energies leave after a lobe: sqrt(sum k_l^2 S_l / 4 pi).
[[nodiscard]] double blurred_rms(double alpha, std::span<const double> energies);

// The light that settings of skies are judged by.

/// Throws `Error` (invalid_argument) unless there is at least one, each finite and with a length.
void check_suns(std::span<const glm::dvec3> suns);

/// The largest relative difference |a - b| / |b| over suns.
[[nodiscard]] double worst_difference(std::span<const SphericalHarmonics> a, std::span<const SphericalHarmonics> b);

/// Three bands of the tables' sky for each of the probe's suns, by the default quadrature.
[[nodiscard]] std::vector<SphericalHarmonics> light_of(const SkyTables& tables, const SkyProbe& probe);

}  // namespace welkin::budget
