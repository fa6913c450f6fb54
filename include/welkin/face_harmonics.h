// A cubemap's projection face by face: when one face changes, one face is projected again.
//
//   welkin::FaceHarmonics kept = welkin::project_faces(cubemap);
//   cubemap.faces[2] = new_sky;
//   welkin::update_faces(kept, cubemap, {{2}});
//   welkin::Projection light = welkin::total(kept);             // the very bits of project(cubemap)
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "welkin/export.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

namespace projection {
struct FaceSums;
}

/// What each face adds to a projection, before the faces are added up: sums in double of every tile. Copies share them.
/// Some 0.15 % of the pixels as RGB floats with three bands.
class FaceHarmonics {
 public:
  [[nodiscard]] int size() const noexcept { return size_; }  ///< texels along an edge; 0: nothing is kept
  /// Those that the sums were made with.
  [[nodiscard]] const ProjectionOptions& options() const noexcept { return options_; }
  /// Memory of the sums.
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// The sums of a face, 0 to 5: which face it is does not matter to them. For caches.
  [[nodiscard]] const std::shared_ptr<const projection::FaceSums>& face(int face) const {
    return faces_[static_cast<std::size_t>(face)];
  }

  /// No sums yet.
  FaceHarmonics() = default;
  /// Without any sums yet. For `project_faces`.
  FaceHarmonics(int size, const ProjectionOptions& options) : size_(size), options_(options) {}
  /// Replaces the sums of a face. For `update_faces`.
  void set_face(int face, std::shared_ptr<const projection::FaceSums> sums) {
    faces_[static_cast<std::size_t>(face)] = std::move(sums);
  }

 private:
  int size_ = 0;
  ProjectionOptions options_{};
  std::array<std::shared_ptr<const projection::FaceSums>, 6> faces_{};
};

/// Projects all six faces and keeps their sums. Costs what `project` costs. Throws as `project`, and invalid_argument
/// for a target size with the midpoint rule: Babylon.js's reduction is a pass of its own.
[[nodiscard]] FaceHarmonics project_faces(const CubemapView& cubemap, const ProjectionOptions& options = {},
                                          const Control& control = {});

/// Projects `faces` (each 0 to 5, at most once) again, with the options of `kept`; pixels of the others are not read.
/// Throws as `project`, and invalid_argument for another size than before; then `kept` is what it was.
void update_faces(FaceHarmonics& kept, const CubemapView& cubemap, std::span<const int> faces,
                  const Control& control = {});

/// The projection: the bits of `project`, diagnostics included. Microseconds: no pixel is read. Throws `Error`
/// (invalid_argument) if a face has no sums.
[[nodiscard]] Projection total(const FaceHarmonics& faces);

}  // namespace welkin
