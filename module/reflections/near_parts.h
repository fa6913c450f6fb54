// The near parts of narrow lobes, of either kind of source: see `add_near_parts`.
#pragma once

#include <array>

#include "projection/sanitized_pixels.h"
#include "reflections/gaussian_kernels.h"
#include "reflections/narrow.h"
#include "reflections/narrow_kernels.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// What all texels of a mip share.
struct NearPart {
  const projection::SanitizedSource& source;
  NarrowSplit split;
  double energy;  ///< of the whole lobe's: even light gives as much
  int size;       ///< of the mip
  std::array<float*, 6> faces;
};

/// The texels about each direction in closed form.
void add_cubemap_near(const NearPart& part, const SplitLobe& lobe, const Control& control);

/// Sums of Gaussians, whose shares in a texel are products of what rows and columns have of them.
void add_lat_long_near(const NearPart& part, const GaussianLobe& gaussians, const Control& control);

}  // namespace welkin::reflections
