// The prefilter from the inside: what it leaves for whoever bakes more than reflections.
#pragma once

#include <optional>

#include "transform/spectrum.h"
#include "welkin/specular.h"

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

}  // namespace welkin::reflections
