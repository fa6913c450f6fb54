// What each mip of a prefiltered cubemap is, and how it will be made: decided before any pixel is read.
#pragma once

#include <cstddef>
#include <vector>

#include "specular/band_choice.h"
#include "welkin/specular.h"

namespace welkin::specular {

struct MipPlan {
  int size = 0;
  double roughness = 0.0;
  double alpha = 0.0;
  bool copy = false;                                    ///< roughness 0: no blur
  PrefilterMethod method = PrefilterMethod::reference;  ///< never automatic; nothing where `copy` is set
  BandChoice bands;                                     ///< spectral
};

struct PrefilterPlan {
  std::vector<MipPlan> mips;
  double reach = 0.0;    ///< see `choose_bands`
  int bands = 0;         ///< of the transform that all spectral mips share; 0: there are none
  bool sampled = false;  ///< whether a mip is

  /// Alpha of the spectral mip with the narrowest lobe; 1 if there is none.
  [[nodiscard]] double least_alpha() const noexcept;
  /// Rows of the lat-long, twice as wide, that a cubemap goes through on its way to harmonics: a multiple of 2 size
  /// (of 4 size up to 512), no
  /// higher than 0.3 of the narrowest lobe's alpha, if some 2048 rows do.
  [[nodiscard]] int rows_for_cubemap(int size) const noexcept;
  /// The largest of the spectral mips' losses at a peak.
  [[nodiscard]] double loss_at_peak() const noexcept;
};

/// Throws `Error`: invalid_argument for options out of range, limit_exceeded for error bounds or lobes that are out of
/// reach.
[[nodiscard]] PrefilterPlan plan_prefilter(const PrefilterOptions& options);

}  // namespace welkin::specular
