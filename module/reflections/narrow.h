// Lobes too narrow for harmonics alone: the near part texel by texel, the far part by harmonics.
//
// The far part is a polynomial near the direction (`kFarPart`) and all of the lobe beyond; the near part is what is
// left, and ends some texels away.
#pragma once

#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/halved_faces.h"
#include "reflections/near_weights.h"
#include "transform/spectrum.h"

namespace welkin::reflections {

/// Returns where the lobe of a mip is split: sums over many texels' windows and harmonics of many bands take about as
/// long. `rows`: of a lat-long; 0: a cubemap. Texels that are large beside the near part count as several, so the split
/// has more of them, and a lat-long's columns divide by four.
[[nodiscard]] NearSplit narrow_split(int columns, int rows, int size, double alpha);

/// Returns alpha of a lobe that is about as narrow as the far part's peak, as the bright texels are found for it.
[[nodiscard]] inline double sharpest_lobe(const NearSplit& split) noexcept { return split.reach / 3.0; }
/// Times `sharpest_lobe`, the alpha that two points a texel's edge do for.
inline constexpr double kFarLights = 2.0;
/// Returns the rings on which the far part is held.
[[nodiscard]] inline transforms::GridSize far_grid(const NearSplit& split) noexcept {
  return transforms::grid_for_bands(split.bands, 1.2);
}
/// Returns rows of the lat-long, twice as wide, through which a cubemap gets to harmonics.
[[nodiscard]] int far_rows_for_cubemap(const NearSplit& split) noexcept;

/// Returns a source's rows of `columns`, their texels cut as a split has them. `source` is to outlive them.
[[nodiscard]] SourceRows cut_rows(std::vector<const float*> source, int columns, const NearSplit& split);

/// Returns what a mip takes of the far part's spectrum, whose end is tapered.
[[nodiscard]] std::vector<double> tapered(const std::vector<double>& spectrum, int bands);
/// Returns what that leaves out of a picture with such energies (`energies_of`), root mean square over the sphere.
/// `rings`: those a cubemap was read on, which lose some of each band; 0: of a lat-long.
[[nodiscard]] double lost_of_far(const std::vector<double>& spectrum, const std::vector<double>& taken,
                                 const std::vector<double>& energies, int rings);

/// Returns the contrast of a source. For cubemaps it is the root mean square of the differences between neighbouring
/// texels along both axes. For lat-longs it is the root of the sum over edges between texels of squared step times
/// length, per unit of solid angle: a lobe of width w is cut by an edge on w times that length.
[[nodiscard]] double contrast_of(const projection::SanitizedSource& source);
/// The same of a cubemap's packed rows, face after face.
[[nodiscard]] double contrast_of_faces(const std::vector<const float*>& rows, int columns);

struct NarrowMip {
  int size = 0;
  double alpha = 0.0;
  double rms = 0.0;      ///< of the mip's texels, which may miss every lamp
  double far_rms = 0.0;  ///< of its far part, over the whole sphere
  double lost = 0.0;     ///< see `lost_of_far`
  double lights = 0.0;   ///< the far part's share of the lobe if bright texels were taken out, else 0
};

/// Returns the estimated root mean square error of a mip over its own root mean square (docs/maths/reflections.md has
/// measurements): what the far part's bands leave out, a share of the steps that grows with alpha for cubemaps and with
/// its root for lat-longs, the places of lines in floats, and no more of those two than the error of any texel's
/// weight; and what bright texels' points give in place of their areas.
[[nodiscard]] double narrow_error(const projection::SanitizedSource& source, const NarrowMip& mip, double contrast);

}  // namespace welkin::reflections
