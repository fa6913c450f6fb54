// Reflections of a computed sky.
#pragma once

#include <glm/vec3.hpp>

#include "welkin/control.h"
#include "welkin/export.h"
#include "welkin/sky_view.h"
#include "welkin/specular.h"

namespace WELKIN_EXPORT welkin {

/// A sky cubemap of `options.size` prefiltered as `prefilter_specular` does; the sun's disc is left out unless asked
/// for. Throws `Error`: invalid_argument, limit_exceeded, cancelled.
[[nodiscard]] PrefilteredSpecular sky_specular(const SkyView& view, const glm::dvec3& sun,
                                               const PrefilterOptions& options, const SkyPictureOptions& picture = {},
                                               const Control& control = {});

}  // namespace welkin
