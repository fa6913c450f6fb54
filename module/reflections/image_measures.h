// Measures of images and of chains' levels: contrast, root mean square, smallest channel.
#pragma once

#include <vector>

#include "projection/sanitized_pixels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// Returns the contrast of a source. For cubemaps it is the root mean square of the differences between neighbouring
/// texels along both axes. For lat-longs it is the root of the sum over edges between texels of squared step times
/// length, per unit of solid angle: a lobe of width w is cut by an edge on w times that length.
[[nodiscard]] double contrast_of(const projection::SanitizedSource& source);
/// Returns the contrast of a cubemap that is given by its packed rows, face after face.
[[nodiscard]] double contrast_of_faces(const std::vector<const float*>& rows, int columns);

/// Returns the root mean square over the sphere of a level's radiance, all three channels together, from at most
/// `samples` x `samples` texels per face. For lobes that are wider than the distance between these texels 128 suffice.
[[nodiscard]] double rms_of_level(const Cubemap& chain, int level, int samples = 128);

/// Returns the smallest channel of a level's texels.
[[nodiscard]] double least_of(const Cubemap& chain, int level, const Control& control);

}  // namespace welkin::reflections
