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

/// Makes the tables that cubemaps of such faces take by the plan, if they are not kept yet. Throws `Error` (cancelled).
void make_tables(const PrefilterPlan& plan, int face_size, const Control& control);

/// Resamples RGB floats by area into a level of `chain`: a copy of a cubemap of the same size.
void fill_level(const LatLongView& source, CubemapChain& chain, int level, const Control& control);
void fill_level(const CubemapView& source, CubemapChain& chain, int level, const Control& control);

/// Fills in `pixels`, but for its passes: what was read, as sanitizing found it. The total radiance is that of the mip
/// with the most texels: centres stand for texels there.
void describe_pixels(const ProjectionDiagnostics& sanitized, const glm::dvec3& clamped_radiance,
                     PrefilteredSpecular& specular);

// A cubemap on rings of latitude.

/// A packed RGB float cubemap as a lat-long of 2 rows x rows texels, each the mean of the cube's texels over its area.
/// Where rows is a multiple of the faces' 2 size, a cube's texel is cut into as many parts first: edges between texels
/// are followed in steps of a part, not of a texel. The same bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] LatLongImage rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

/// What a transform takes for a cubemap: by a `RingTable`, or, where there is none, `rings_of_cubemap` sharpened.
[[nodiscard]] LatLongImage sharp_rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

/// The environment as the transform reads it: a lat-long of sanitized pixels, its bright texels taken out.
struct Rings {
  LatLongView view{};
  LatLongImage owned;  ///< holds the pixels where the caller's own would not do

  [[nodiscard]] std::size_t bytes() const { return owned.pixels.size() * sizeof(float); }
};

/// `source` without `bright`: itself if it is a lat-long with none, else a copy; a cubemap on `rows` rings.
[[nodiscard]] Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright,
                             int rows, const Control& control);

/// A bound on what that takes beside the rings, a `RingTable` that has yet to be made included.
[[nodiscard]] std::size_t cube_rings_bytes(int face_size, int rows);

// Radiance so large that sums over it would leave the range of floats, or so small that they would lose bits.

/// The power of two that a picture is to be multiplied by before it is transformed: 2^-64 where a magnitude is above
/// 1e30, 2^100 where none is above 1e-25, 1 elsewhere and of black.
[[nodiscard]] float safe_scale(const projection::SanitizedSource& source) noexcept;

/// The picture times that: exact, but for what is 1e50 times darker than the brightest.
[[nodiscard]] LatLongImage scaled(const projection::SanitizedSource& source, const LatLongView& view, float scale);
[[nodiscard]] CubemapImage scaled(const projection::SanitizedSource& source, const CubemapView& view, float scale);

/// What was made of such a picture over the same scale. No value rounds beyond the floats.
void undo_scale(PrefilteredSpecular& result, float scale);

}  // namespace welkin::reflections
