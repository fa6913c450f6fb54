// Projects a checked cubemap at its own size.
#pragma once

#include "welkin/projection.h"

namespace welkin::sh {

/// `cubemap` and `options` have been checked; `options.target_size` is 0 or below the cubemap's size, and then
/// averages by solid angle. Throws `Error` (rejected_pixel, cancelled).
/// The diagnostics lack passes and the error estimate, which the caller knows more about.
[[nodiscard]] Projection project_cubemap(const CubemapView& cubemap, const ProjectionOptions& options,
                                         const Control& control);

}  // namespace welkin::sh
