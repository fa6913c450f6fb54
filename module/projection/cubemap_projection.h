// Projects a checked cubemap at its own size.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "projection/midpoint_error.h"
#include "projection/tile_sums.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {

/// `cubemap` and `options` have been checked; `options.target_size` is none or below the cubemap's size, and then
/// averages by solid angle. Throws `Error` (rejected_pixel, cancelled).
[[nodiscard]] Projection project_cubemap(const CubemapView& cubemap, const ProjectionOptions& options,
                                         const Control& control);

inline constexpr std::array<int, 6> kAllFaces{0, 1, 2, 3, 4, 5};
using SixFaceSums = std::array<std::shared_ptr<const FaceSums>, 6>;

/// The sums of some faces (0 to 5, none twice), null for the others. Throws likewise.
[[nodiscard]] SixFaceSums sum_faces(const CubemapView& cubemap, const ProjectionOptions& options,
                                    std::span<const int> faces, const Control& control);

/// `project_cubemap` from the sums of all six faces of a cubemap of `size`: the same bits. Its passes take no time.
[[nodiscard]] Projection total_of_faces(const SixFaceSums& faces, int size, const ProjectionOptions& options);

/// How many tiles' sums a face of that size has.
[[nodiscard]] std::size_t tiles_of_face(int size, const ProjectionOptions& options);

/// The diagnostics of six faces of `size`, but for the passes and the error estimate.
[[nodiscard]] ProjectionDiagnostics cubemap_diagnostics(int size, std::span<const glm::dvec3> radiance,
                                                        const SanitizeRecord& record);

/// The error estimate of a projection by the midpoint rule. `off`: what `MidpointError::add` returned.
[[nodiscard]] double midpoint_estimate(std::span<const glm::dvec3> radiance, std::span<const glm::dvec3> off,
                                       const MidpointError& error);

}  // namespace welkin::projection
