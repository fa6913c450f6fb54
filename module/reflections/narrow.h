// Lobes too narrow for harmonics alone: the near part texel by texel, the far part by harmonics.
//
// The lobe is a mixture of Gaussians, 1 / (q + s)^2 = Int t e^(-t (q + s)) dt, s = sin^2(theta / 2). What lies below
// t = split is smooth and needs few bands, what lies above ends within a few texels: Ewald's way to sum (1921).
#pragma once

#include <array>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "transform/spectrum.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Where lobes are split, for a source.
struct NarrowSplit {
  int bands = 0;             ///< of the far part
  double split = 0.0;        ///< the t above; of lat-longs that of the widest Gaussian in the near part
  double largest_far = 0.0;  ///< of cubemaps `split`; of lat-longs the t of the narrowest Gaussian in the far part
  double reach = 0.0;        ///< radians, of cubemaps: the near part beyond is below a thousandth of the lobe there
  int columns = 0;           ///< the source's, or a face's; large texels of a cubemap count as several small ones,
  int rows = 0;              ///< so that the far part changes little over each
};
/// alpha of a lobe that is about as wide as the narrowest Gaussian that is far, as the bright texels are found for it.
[[nodiscard]] double sharpest_far_lobe(const NarrowSplit& split) noexcept;
/// Times that, the alpha that two points a texel's edge do for.
inline constexpr double kFarLights = 3.0;

/// `rows`, `columns`: of a lat-long, or of a cubemap's face.
[[nodiscard]] NarrowSplit split_for(bool cubemap, int columns, int rows) noexcept;

/// The first bands of the far part's spectrum, over k_0 of the whole lobe.
[[nodiscard]] std::vector<double> far_part(bool cubemap, const NarrowSplit& split, double alpha, int bands);

/// The rings on which the far part is held.
[[nodiscard]] transforms::GridSize grid_of_far_part(bool cubemap, const NarrowSplit& split) noexcept;

/// Rows of the lat-long, twice as wide, on which a cubemap's far part is found.
[[nodiscard]] int rows_for_far_part(const NarrowSplit& split) noexcept;

/// Returns the contrast of a source. For cubemaps it is the root mean square of the differences between neighbouring
/// texels along both axes. For lat-longs it is the root of the sum over edges between texels of squared step times
/// length, per unit of solid angle: a lobe of width w is cut by an edge on w times that length.
[[nodiscard]] double contrast_of(const projection::SanitizedSource& source);

struct NarrowMip {
  int size = 0;
  double alpha = 0.0;
  double rms = 0.0;      ///< of the mip's texels, which may miss every lamp
  double far_rms = 0.0;  ///< of its far part, over the whole sphere
};

/// Returns the estimated root mean square error of a mip over its own root mean square (docs/reflections.md has
/// measurements): a share of the steps, proportional to alpha for cubemaps and to its root for lat-longs, plus the cost
/// of clearing a cubemap's lines if all centres lie on them, and no more than the error of any texel's weight.
[[nodiscard]] double narrow_error(const projection::SanitizedSource& source, const NarrowMip& mip, double contrast);

/// Adds the near part about the centre of each texel to six packed RGB faces that hold the far part: the source's
/// texels as areas. alpha in (0, 0.01]. An even source stays even. Of a lat-long without negative values no result is
/// below 0. The same bits on any number of threads and instruction set. Throws `Error` (cancelled).
void add_near_parts(const projection::SanitizedSource& source, const NarrowSplit& split, double alpha, int size,
                    const std::array<float*, 6>& faces, const Control& control);

/// What that takes in each worker over a lat-long, at most: whole rows of weights beside the poles.
[[nodiscard]] std::size_t lat_long_room_bytes(const NarrowSplit& split) noexcept;

}  // namespace welkin::reflections
