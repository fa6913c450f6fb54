// Lobes too narrow for harmonics alone: the near part texel by texel, the far part by harmonics.
//
// The lobe is a mixture of Gaussians, 1 / (q + s)^2 = Int t e^(-t (q + s)) dt, s = sin^2(theta / 2). What lies below
// t = split is smooth and needs few bands, what lies above ends within a few texels: Ewald's way to sum (1921).
#pragma once

#include <array>

#include "projection/sanitized_pixels.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Where lobes are split, for a source. Large texels count as several small ones, so that the far part changes little
/// over each.
struct NarrowSplit {
  int bands = 0;       ///< of the far part
  double split = 0.0;  ///< the t above
  double reach = 0.0;  ///< radians: the near part beyond is below a thousandth of the lobe there
  int columns = 0;     ///< small texels along a row (of a face)
  int rows = 0;        ///< and down a column (of a face)
};
/// `rows`, `columns`: of a lat-long, or of a cubemap's face.
[[nodiscard]] NarrowSplit split_for(bool cubemap, int columns, int rows) noexcept;

/// Rows of the lat-long, twice as wide, on which a cubemap's far part is found.
[[nodiscard]] int rows_for_far_part(int face_size, const NarrowSplit& split) noexcept;

/// What the largest relative error of such a mip is estimated to be: docs/reflections.md has what was measured. What a
/// bright texel sends far is known to 0.6 %; that counts where it outshines a dark texel.
[[nodiscard]] double narrow_error(const projection::SanitizedSource& source, const NarrowSplit& split,
                                  double alpha) noexcept;

/// Adds the near part about the centre of each texel to six packed RGB faces that hold the far part: the source's
/// texels as areas, their integrals in closed form. alpha in (0, 0.01]. An even source stays even. The same bits on any
/// number of threads and instruction set. Throws `Error` (cancelled).
void add_near_parts(const projection::SanitizedSource& source, const NarrowSplit& split, double alpha, int size,
                    const std::array<float*, 6>& faces, const Control& control);

}  // namespace welkin::reflections
