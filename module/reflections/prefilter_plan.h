// What each mip of a prefiltered cubemap is, and how it will be made: decided before any pixel is read.
#pragma once

#include <cstddef>
#include <vector>

#include "reflections/band_choice.h"
#include "reflections/lobe.h"
#include "reflections/lobe_table.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

struct MipPlan {
  int size = 0;
  double roughness = 0.0;
  double alpha = 0.0;
  MipMethod method = MipMethod::copy;  ///< never `stored`
  BandChoice bands;                    ///< spectral
};

struct PrefilterPlan {
  int size = 0;               ///< of the whole chain
  int chain_mips = 0;         ///< of the whole chain
  std::vector<MipPlan> mips;  ///< that are made
  int first_mip = 0;          ///< the first of them, counted in the whole chain
  int samples = 0;            ///< of the sampled method
  double reach = 0.0;         ///< of lights, see `reach_for`
  ErrorBounds bounds;         ///< asked for
  int tightenings = 0;        ///< of the bounds that spectral mips are made for: see `tightened`

  /// Of the transform that all spectral mips share; 0: none is made. Of the whole chain, as which rings take part and
  /// in which groups they are summed follows from it: coefficients of low bands round otherwise in a transform of
  /// fewer.
  int bands = 0;

  /// Alpha of the spectral mip with the narrowest lobe, 1 if there is none; of the whole chain, as it decides which
  /// texels are taken out: a mip must not change where others are left out.
  double least_alpha = 1.0;

  /// Of the whole chain's spectral mips, as all of them decide whether the bounds are tightened.
  std::vector<double> spectral_alphas;

  /// Whether spectral mips of small cubemaps may be sums over texels instead: see `is_summed`.
  bool sums = false;

  /// Of the whole chain's narrow mips, as those decide which far parts are found: see `far_alphas`.
  std::vector<double> narrow_alphas;

  /// The plan without so many mips at either end. The others keep their bits: all that they depend on stays that of the
  /// whole chain. Throws `Error` (invalid_argument) unless one mip at least is left.
  [[nodiscard]] PrefilterPlan without(int sharp, int rough) const;

  /// Returns the bounds that spectral mips are made for.
  [[nodiscard]] ErrorBounds tight() const noexcept { return bounds.tightened(tightenings); }
  /// Returns the plan with more bands and rings, for a picture with more energy in them than most have.
  [[nodiscard]] PrefilterPlan tightened(int steps) const;

  /// Whether a mip is made by this method.
  [[nodiscard]] bool uses(MipMethod method) const noexcept;

  /// Whether a mip is made by a `LobeTable` if the source is a cubemap of such faces.
  [[nodiscard]] bool is_summed(int face_size, const MipPlan& mip) const noexcept;
  /// All of those.
  [[nodiscard]] std::vector<LobeMip> summed_mips(int face_size) const;
  /// Whether a spectral mip is left.
  [[nodiscard]] bool needs_rings(int face_size) const noexcept;

  /// Rows of the lat-long, twice as wide, that a cubemap goes through on its way to harmonics: `rings_within` by a
  /// `RingTable`. Where there is none: a multiple of 2 face_size (of 4 face_size up to 512), at least 512, no higher
  /// than 0.2 of the narrowest lobe's alpha, if some 2048 rows do.
  [[nodiscard]] int rows_for_cubemap(int face_size) const noexcept;
};

/// The reach of narrow mips, which look at bounds that are tighter than the default's only.
[[nodiscard]] double narrow_reach(const PrefilterPlan& plan) noexcept;

/// Roughness of each mip of the whole chain. Throws `Error` (invalid_argument).
[[nodiscard]] std::vector<double> roughness_of_chain(const PrefilterOptions& options);

/// Throws `Error`: invalid_argument for options out of range, limit_exceeded for error bounds or lobes that are out of
/// reach.
[[nodiscard]] PrefilterPlan plan_prefilter(const PrefilterOptions& options);

}  // namespace welkin::reflections
