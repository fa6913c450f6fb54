// Projects a checked cubemap at its own size.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "projection/midpoint_error.h"
#include "projection/texel_weights.h"
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

/// The sums of some faces (0 to 5, none twice), null for the others. Throws the same errors.
[[nodiscard]] SixFaceSums sum_faces(const CubemapView& cubemap, const ProjectionOptions& options,
                                    std::span<const int> faces, const Control& control);

/// `project_cubemap` from the sums of all six faces of a cubemap of `size`: the same bits. Its passes take no time.
[[nodiscard]] Projection total_of_faces(const SixFaceSums& faces, int size, const ProjectionOptions& options);

/// How many tiles' sums a face of that size has.
[[nodiscard]] std::size_t tiles_of_face(int size, const ProjectionOptions& options);

/// Tables that the projections of all cubemaps of one size share.
struct CubemapTables {
  /// From caches.
  CubemapTables(int size, const ProjectionOptions& options);

  int size;
  int bands;
  std::shared_ptr<const TexelWeights> weights;
  /// The midpoint rule's error; null for the exact rule, and where an average's error is known by other means.
  std::shared_ptr<const MidpointError> error;
};

/// The sums of tiles on their way to a projection: turned from the faces' frames to the world's. Only its constructor
/// allocates.
class WorldSums {
 public:
  /// Makes sums for cubemaps with at most `tiles` tiles.
  WorldSums(std::size_t tiles, const ProjectionOptions& options);

  void clear() noexcept;
  /// Different tiles may be added at the same time.
  void add(const CubemapTables& tables, std::size_t tile, int face, const double* face_sums,
           const SanitizeRecord& record) noexcept;
  /// Writes bands^2 coefficients. Returns their diagnostics but for the passes. Throws `Error` (rejected_pixel).
  ProjectionDiagnostics finish(const CubemapTables& tables, std::span<glm::dvec3> radiance) const;

 private:
  TileSums sums_;
  TileSums off_;  ///< by the midpoint rule
};

}  // namespace welkin::projection
