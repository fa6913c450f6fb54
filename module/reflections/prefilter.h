// The prefilter from the inside: what it leaves for whoever bakes more than reflections.
#pragma once

#include <optional>

#include "projection/sanitized_pixels.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

struct Prefiltered {
  PrefilteredSpecular specular;

  /// The first bands of the environment's harmonics, all of its light included, if they were asked for and a mip was
  /// made by harmonics: they fall out of the same transform.
  std::optional<SphericalHarmonics> harmonics;
};

/// As `prefilter_specular`; `bands` of harmonics beside it, 0 to kMaximumBands. The result is put into `room` if that
/// has its shape.
[[nodiscard]] Prefiltered prefilter(const LatLongView& source, const PrefilterOptions& options, int bands,
                                    CubemapChain room, const Control& control);
[[nodiscard]] Prefiltered prefilter(const CubemapView& source, const PrefilterOptions& options, int bands,
                                    CubemapChain room, const Control& control);

/// Fills in `pixels`, but for its passes: what was read, as sanitizing found it. The total radiance is that of the mip
/// with the most texels: centres stand for texels there.
void describe_pixels(const ProjectionDiagnostics& sanitized, const glm::dvec3& clamped_radiance,
                     PrefilteredSpecular& specular);

// A cubemap on rings of latitude.

/// A packed RGB float cubemap as a lat-long of 2 rows x rows texels, each the mean of the cube's texels over its area.
/// Where rows is a multiple of the faces' 2 size, a cube's texel is cut into as many parts first: edges between texels
/// are followed in steps of a part, not of a texel. The same bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] LatLongImage rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

// Radiance so large that sums over it would leave the range of floats, or so small that they would lose bits.

/// The power of two that a picture is to be multiplied by before it is transformed: 2^-64 where a magnitude is above
/// 1e30, 2^100 where none is above 1e-25, 1 elsewhere and of black.
[[nodiscard]] float safe_scale(const projection::SanitizedSource& source) noexcept;

/// The picture times that: exact, but for what is 1e50 times darker than the brightest.
[[nodiscard]] LatLongImage scaled(const projection::SanitizedSource& source, const LatLongView& view, float scale);
[[nodiscard]] CubemapImage scaled(const projection::SanitizedSource& source, const CubemapView& view, float scale);

/// What was made of such a picture over the same scale. No value rounds beyond the floats.
void undo_scale(Prefiltered& result, float scale);

}  // namespace welkin::reflections
