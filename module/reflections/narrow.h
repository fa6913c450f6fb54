// Lobes too narrow for harmonics alone: the near part texel by texel, the far part by harmonics.
//
// The far part is a polynomial near the direction (`kFarPart`) and all of the lobe beyond; the near part is what is
// left, and ends some texels away.
#pragma once

#include <array>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/texel_images.h"
#include "transform/spectrum.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Where the lobes of a mip are split.
struct NarrowSplit {
  int bands = 0;       ///< of the far part
  double reach = 0.0;  ///< radians, where the near part ends

  /// q + s there, see `kFarPart`.
  [[nodiscard]] double end(double alpha) const noexcept;
  /// alpha of a lobe that is about as narrow as the far part's peak, as the bright texels are found for it.
  [[nodiscard]] double sharpest_lobe() const noexcept { return reach / 3.0; }
  /// The rings on which the far part is held.
  [[nodiscard]] transforms::GridSize grid() const noexcept { return transforms::grid_for_bands(bands, 1.2); }
  /// Rows of the lat-long, twice as wide, through which a cubemap gets to harmonics.
  [[nodiscard]] int rows_for_cubemap() const noexcept;
};
/// Times `sharpest_lobe`, the alpha that two points a texel's edge do for.
inline constexpr double kFarLights = 2.0;

/// How texels of such a source (`rows`: of a lat-long, or of a cubemap's face) are cut for narrow lobes.
[[nodiscard]] TexelParts parts_for(bool cubemap, int columns, int rows) noexcept;

/// Where the lobes of a mip of `size` are split: sums over many texels' windows and harmonics of many bands take
/// about as long.
[[nodiscard]] NarrowSplit split_for(bool cubemap, int columns, int rows, int size);

/// The far part's spectrum, over k_0 of the whole lobe, a quarter beyond its bands; and what the mip takes of it, whose
/// end is tapered.
[[nodiscard]] std::vector<double> far_part(const NarrowSplit& split, double alpha);
[[nodiscard]] std::vector<double> tapered(const std::vector<double>& spectrum, int bands);
/// What that leaves out of a picture with such energies (`energies_of`), root mean square over the sphere.
[[nodiscard]] double lost_of_far(const std::vector<double>& spectrum, const std::vector<double>& taken,
                                 const std::vector<double>& energies);

/// Returns the contrast of a source. For cubemaps it is the root mean square of the differences between neighbouring
/// texels along both axes. For lat-longs it is the root of the sum over edges between texels of squared step times
/// length, per unit of solid angle: a lobe of width w is cut by an edge on w times that length.
[[nodiscard]] double contrast_of(const projection::SanitizedSource& source);

struct NarrowMip {
  int size = 0;
  double alpha = 0.0;
  double rms = 0.0;      ///< of the mip's texels, which may miss every lamp
  double far_rms = 0.0;  ///< of its far part, over the whole sphere
  double lost = 0.0;     ///< see `lost_of_far`
};

/// Returns the estimated root mean square error of a mip over its own root mean square (docs/reflections.md has
/// measurements): what the far part's bands leave out, a share of the steps that grows with alpha for cubemaps and with
/// its root for lat-longs, the places of lines in floats, and no more of those two than the error of any texel's
/// weight.
[[nodiscard]] double narrow_error(const projection::SanitizedSource& source, const NarrowMip& mip, double contrast);

/// What all texels of a mip share.
struct NearPart {
  const TexelImages& images;
  NarrowSplit split;
  double energy;  ///< of the whole lobe's: even light gives as much
  int size;       ///< of the mip
  std::array<float*, 6> faces;
};

/// Adds the near part about the centre of each texel to six packed RGB faces that hold the far part: the source's
/// texels as areas. alpha in (0, 0.01]. The same bits on any number of threads and instruction set. Throws `Error`
/// (cancelled).
void add_near_part(const NearPart& part, double alpha, const Control& control);

}  // namespace welkin::reflections
