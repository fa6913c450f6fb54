// Projects a checked cubemap at its own size.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "projection/project.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {

class TexelWeights;

/// `cubemap` and `options` have been checked; `options.target_size` is none or below the cubemap's size, and then
/// averages by solid angle. Throws `Error` (rejected_pixel, cancelled).
/// The diagnostics lack passes and the error estimate, which `describe_projection` adds.
[[nodiscard]] Projection project_cubemap(const CubemapView& cubemap, const ProjectionOptions& options,
                                         const Control& control);

using SixFaceSums = std::array<std::shared_ptr<const FaceSums>, 6>;

/// The sums of some faces (0 to 5, none twice), null for the others. Throws likewise.
[[nodiscard]] SixFaceSums sum_faces(const CubemapView& cubemap, const ProjectionOptions& options,
                                    std::span<const int> faces, const Control& control);

/// `project_cubemap` from the sums of all six faces of a cubemap of `size`: the same bits.
[[nodiscard]] Projection total_of_faces(const SixFaceSums& faces, int size, const ProjectionOptions& options);

/// How many tiles' sums a face of that size has.
[[nodiscard]] std::size_t tiles_of_face(int size, const ProjectionOptions& options);

/// Adds the error estimate and the passes, "project" without its time being the last.
void describe_projection(Projection& projection, int size, const ProjectionOptions& options);

/// Many small cubemaps: each is projected whole by one thread, with the bits of `project`, and without the heap.
///
/// Name the sizes that occur (`prepare`), then say how many threads there are (`make_rooms`), then project.
class SmallCubemaps {
 public:
  /// `options` have been checked. `one_of_many`: most pixels must come from memory, and are asked for ahead.
  SmallCubemaps(const ProjectionOptions& options, bool one_of_many);
  ~SmallCubemaps();
  SmallCubemaps(const SmallCubemaps&) = delete;
  SmallCubemaps& operator=(const SmallCubemaps&) = delete;

  /// Whether they take cubemaps of that size: those that `project` itself leaves to the calling thread, but for the
  /// midpoint rule's reductions, which need memory of their own.
  [[nodiscard]] static bool serves(int size, const ProjectionOptions& options) noexcept;

  void prepare(int size);
  void make_rooms(std::size_t workers);

  /// Writes bands^2 coefficients. A texel that a policy rejects is left in `record`. Different workers may project at
  /// the same time. Allocates nothing.
  [[nodiscard]] ProjectionDiagnostics project(const CubemapView& cubemap, std::size_t worker,
                                              std::span<glm::dvec3> radiance, SanitizeRecord& record) const;

 private:
  struct Room;

  [[nodiscard]] ProjectionOptions options_at(int size) const;

  ProjectionOptions options_;
  bool one_of_many_;
  std::vector<std::shared_ptr<const TexelWeights>> weights_;  ///< by size
  std::vector<std::unique_ptr<Room>> rooms_;                  ///< of each worker
};

}  // namespace welkin::projection
