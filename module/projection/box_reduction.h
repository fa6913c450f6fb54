// Babylon.js's downsampling: a plain box over a cubemap's raw values.
#pragma once

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {

/// Averages each face to target x target (below the cubemap's size) as CubeMapToSphericalPolynomialTools does:
/// cell (i, j) covers source columns floor(i r) to floor((i + 1) r) - 1, r = size / target, and rows alike;
/// its sum is multiplied by 1 / r^2 even where it holds fewer texels, and rounded to float. 8-bit formats
/// are averaged as encoded and rounded to whole steps of 1/255 (half up, modulo 256: with ratios that are not
/// whole a cell may hold more than r^2 texels) before they are linearised.
/// NaN and infinities spread over their cell. Throws `Error`: cancelled, and rejected_pixel for a source texel
/// that a policy of `options` rejects; nothing else of the options matters here.
[[nodiscard]] Cubemap reduce_by_box(const CubemapView& cubemap, int target, const ProjectionOptions& options,
                                    const Control& control);

}  // namespace welkin::projection
