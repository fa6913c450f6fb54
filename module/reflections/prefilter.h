// The prefilter from the inside: what it leaves for whoever bakes more than reflections.
#pragma once

#include <cstddef>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/bright_texels.h"
#include "reflections/prefilter_plan.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

/// As `prefilter_specular`, of a plan. The result is put into `room` if that has its shape.
[[nodiscard]] PrefilteredSpecular prefilter(const LatLongView& source, const PrefilterPlan& plan,
                                            const PixelPolicy& pixels, CubemapChain room, const Control& control);
[[nodiscard]] PrefilteredSpecular prefilter(const CubemapView& source, const PrefilterPlan& plan,
                                            const PixelPolicy& pixels, CubemapChain room, const Control& control);

/// Prefilters pixels that have been sanitized before: its record says that nothing was replaced, and its memory does
/// not count theirs.
[[nodiscard]] PrefilteredSpecular prefilter(const projection::SanitizedSource& source, const PrefilterPlan& plan,
                                            CubemapChain room, const Control& control);

/// Makes the tables that cubemaps of such faces take by the plan, if they are not kept yet. Throws `Error` (cancelled).
void make_tables(const PrefilterPlan& plan, int face_size, const Control& control);

/// Resamples RGB floats by area into a level of `chain`: a copy of a cubemap of the same size.
void fill_level(const LatLongView& source, CubemapChain& chain, int level, const Control& control);
void fill_level(const CubemapView& source, CubemapChain& chain, int level, const Control& control);

/// Fills in `pixels`, but for its passes: what was read, as sanitizing found it. The total radiance is that of the mip
/// with the most texels: centres stand for texels there.
void describe_pixels(const ProjectionDiagnostics& sanitized, const glm::dvec3& clamped_radiance,
                     PrefilteredSpecular& specular);

}  // namespace welkin::reflections
