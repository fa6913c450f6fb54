// The sums of a cubemap's faces, kept one by one.
#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "image/pixels.h"
#include "platform/float_environment.h"
#include "projection/cubemap_projection.h"
#include "projection/sanitizer.h"
#include "projection/target_size.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

/// As the projection itself wants them: with the target that counts.
ProjectionOptions effective(int size, ProjectionOptions options) {
  options.target_size = projection::effective_target(size, options);
  return options;
}

void check_faces(std::span<const int> faces) {
  unsigned seen = 0;
  for (const int face : faces) {
    if (face < 0 || face > 5) refuse("face " + std::to_string(face) + "; a cubemap has faces 0 to 5");
    const unsigned bit = 1U << static_cast<unsigned>(face);
    if ((seen & bit) != 0) refuse("face " + std::to_string(face) + " is named twice; name each face once");
    seen |= bit;
  }
}

}  // namespace

std::size_t FaceHarmonics::bytes() const noexcept {
  std::size_t bytes = sizeof *this;
  for (const auto& face : faces_) bytes += face ? face->bytes() : 0;
  return bytes;
}

FaceHarmonics project_faces(const CubemapView& cubemap, const ProjectionOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  FaceHarmonics faces(cubemap.size, options);
  constexpr std::array<int, 6> kAll{0, 1, 2, 3, 4, 5};
  update_faces(faces, cubemap, kAll, control);
  return faces;
}

void update_faces(FaceHarmonics& kept, const CubemapView& cubemap, std::span<const int> faces, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(cubemap);
  projection::check_options(kept.options());
  if (kept.options().quadrature == Quadrature::midpoint && projection::effective_target(cubemap.size, kept.options())) {
    refuse("sums of faces are not kept for a target size with the midpoint rule; pass no target_size, or exact");
  }
  check_faces(faces);
  if (cubemap.size != kept.size()) {
    refuse("a cubemap of " + std::to_string(cubemap.size) + ", but sums of one of " + std::to_string(kept.size()) +
           " are kept; call project_faces");
  }
  if (faces.empty()) return;
  const projection::SixFaceSums sums =
      projection::sum_faces(cubemap, effective(kept.size(), kept.options()), faces, control);
  for (const int face : faces) kept.set_face(face, sums[static_cast<std::size_t>(face)]);
}

Projection combine(const FaceHarmonics& faces) {
  const platform::FloatingPointScope floating_point;
  projection::SixFaceSums sums;
  for (int face = 0; face < 6; ++face) {
    sums[static_cast<std::size_t>(face)] = faces.face(face);
    if (!faces.face(face)) refuse("face " + std::to_string(face) + " has no sums; call project_faces or update_faces");
  }
  const ProjectionOptions options = effective(faces.size(), faces.options());
  const auto functions = static_cast<std::size_t>(options.bands) * static_cast<std::size_t>(options.bands);
  for (const auto& face : sums) {
    if (face->functions == functions && face->records.size() == projection::tiles_of_face(faces.size(), options))
      continue;
    refuse("a face's sums are of another size or other options; call project_faces");
  }
  return projection::total_of_faces(sums, faces.size(), options);
}

}  // namespace welkin
