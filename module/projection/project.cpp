// The public calls, of images and of faces alone: arguments checked, the size chosen, the passes recorded.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/pixels.h"
#include "jobs/stopwatch.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/box_reduction.h"
#include "projection/cubemap_projection.h"
#include "projection/lat_long_projection.h"
#include "projection/projection_error.h"
#include "projection/sanitizer.h"
#include "projection/target_size.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin {
namespace {

void check_chain(std::span<const CubemapView> mips) {
  if (mips.empty()) throw Error(ErrorCode::invalid_argument, "the mip chain is empty; pass at least the full size");
  for (std::size_t level = 0; level < mips.size(); ++level) {
    image::check_view(mips[level]);
    if (level == 0) continue;
    const int expected = std::max(1, mips[level - 1].size / 2);
    if (mips[level].size != expected || mips[level].format != mips[0].format || mips[level - 1].size == 1) {
      throw Error(ErrorCode::invalid_argument,
                  "mip level " + std::to_string(level) + " has size " + std::to_string(mips[level].size) +
                      "; after a level of size " + std::to_string(mips[level - 1].size) + " it must be half that (" +
                      std::to_string(expected) + "), of the same format, and 1 is the last");
    }
  }
}

/// Projects by Babylon.js's reduction; its loss is the difference to the sums of texels as areas.
Projection project_boxes(const CubemapView& cubemap, int target, const ProjectionOptions& options,
                         const Control& control) {
  const jobs::Stopwatch reducing;
  const projection::ReducedCubemap reduced =
      projection::reduce_by_box(cubemap, target, options, jobs::part_of(control, 0.0, 0.6));
  const double milliseconds = reducing.milliseconds();
  ProjectionOptions whole = options;
  whole.quadrature = Quadrature::exact;
  const Projection exact = projection::project_cubemap(cubemap, whole, jobs::part_of(control, 0.6, 0.9));
  Projection projection = projection::project_cubemap(reduced.view, options, jobs::part_of(control, 0.9, 1.0));
  projection.diagnostics.texels = exact.diagnostics.texels;
  projection.diagnostics.error_estimate =
      projection::relative_error(projection.radiance.coefficients(), exact.radiance.coefficients());
  projection.diagnostics.passes.insert(
      projection.diagnostics.passes.begin(),
      {"reduce", PassAction::run, "plain box to " + std::to_string(target) + ", before gamma and clamp", milliseconds});
  return projection;
}

Projection project_level(const CubemapView& cubemap, ProjectionOptions options, const Control& control) {
  const std::optional<int> target = projection::effective_target(cubemap.size, options);
  const bool midpoint = options.quadrature == Quadrature::midpoint;
  options.target_size = midpoint ? std::nullopt : target;
  if (target && midpoint) return project_boxes(cubemap, *target, options, control);
  return projection::project_cubemap(cubemap, options, control);
}

}  // namespace

Projection project(std::span<const CubemapView> mips, const ProjectionOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  check_chain(mips);
  projection::check_options(options);
  const std::optional<int> target = projection::effective_target(mips[0].size, options);
  if (!target || mips.size() == 1) return project_level(mips[0], options, control);
  std::vector<int> sizes;
  for (const CubemapView& mip : mips) sizes.push_back(mip.size);
  const CubemapView& level = mips[projection::nearest_level(sizes, *target)];
  ProjectionOptions at_level = options;
  at_level.target_size.reset();
  Projection projection = project_level(level, at_level, control);
  if (level.size < mips[0].size) {
    double& error = projection.diagnostics.error_estimate;
    const double of_mip = projection::mip_error(projection.radiance.coefficients(), level.size);
    error = std::sqrt(error * error + of_mip * of_mip);
  }
  projection.diagnostics.passes.insert(
      projection.diagnostics.passes.begin(),
      {"reduce", PassAction::reuse, "the mip chain has a level of size " + std::to_string(level.size)});
  return projection;
}

namespace {

Projection project_level(const LatLongView& lat_long, const ProjectionOptions& options, const Control& control) {
  const jobs::Stopwatch projecting;
  const std::int64_t texels = std::int64_t{lat_long.width} * lat_long.height;
  const jobs::Placement placement = jobs::placement_for(texels);
  const std::size_t workers = jobs::worker_count(placement);
  projection::LatLongProjector projector(lat_long.width, lat_long.height, options, workers);
  jobs::run_tiles(static_cast<std::size_t>(projector.block_count()), placement, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    const int block = static_cast<int>(tile);
                    const int first_row = block * projector.rows_per_block();
                    LatLongView rows = lat_long;
                    rows.pixels = image::row_of(lat_long, first_row);
                    rows.height = std::min(projector.rows_per_block(), lat_long.height - first_row);
                    projector.project_block(block, rows, worker);
                  });
  Projection projection = projector.finish();
  projection.diagnostics.passes.push_back({"cubemap", PassAction::skip, "a lat-long is projected row by row as it is"});
  projection.diagnostics.passes.push_back(
      {"project", PassAction::run, std::to_string(lat_long.width) + " x " + std::to_string(lat_long.height) + " texels",
       projecting.milliseconds()});
  return projection;
}

}  // namespace

Projection project(const EnvironmentView& environment, const ProjectionOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(environment);
  projection::check_options(options);
  return image::with_view(environment, [&](const auto& view) { return project_level(view, options, control); });
}

namespace {

// The sums of a cubemap's faces, kept one by one.

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
  update_faces(faces, cubemap, projection::kAllFaces, control);
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

const char* name(PassAction action) noexcept {
  static constexpr std::array kNames{"run", "reuse", "skip"};
  return platform::name_in<PassAction::skip>(kNames, action, "skip");
}

}  // namespace welkin
