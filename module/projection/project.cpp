#include "projection/project.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "projection/box_reduction.h"
#include "projection/cubemap_projection.h"
#include "projection/lat_long_projection.h"
#include "projection/sanitizer.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin {

const char* name(PassAction action) noexcept {
  switch (action) {
    case PassAction::run: return "run";
    case PassAction::reuse: return "reuse";
    case PassAction::skip: break;
  }
  return "skip";
}

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

Projection total(const FaceHarmonics& faces) {
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
  Projection projection = projection::total_of_faces(sums, faces.size(), options);
  projection::describe_projection(projection, faces.size(), options);
  return projection;
}

}  // namespace welkin

namespace welkin::projection {

SphericalHarmonics TileSums::total() const {
  std::vector<double> sums(3 * functions_);
  for (std::size_t at = 0; at < values_.size(); at += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += values_[at + k];
  }
  SphericalHarmonics result(static_cast<int>(std::lround(std::sqrt(static_cast<double>(functions_)))));
  for (std::size_t f = 0; f < functions_; ++f) {
    result.coefficients()[f] = {sums[f], sums[functions_ + f], sums[2 * functions_ + f]};
  }
  return result;
}

SanitizeRecord TileSums::total_record() const {
  SanitizeRecord total;
  for (const SanitizeRecord& record : records_) total.add(record);
  return total;
}

bool all_finite(std::span<const double> sums) noexcept {
  // x - x is 0 for finite x and NaN else; adding those up needs no branch.
  double poison = 0.0;
  for (const double sum : sums) poison += sum - sum;
  return poison == 0.0;
}

void weighted_sums_in_double(const double* planes, int class_count, const float* weights, const ClassCounts& counts,
                             int positions, double* sums) noexcept {
  for (int channel = 0; channel < 3; ++channel) {
    const float* weight = weights;
    for (int symmetry = 0; symmetry < class_count; ++symmetry) {
      const double* const plane = planes + static_cast<std::ptrdiff_t>(channel * class_count + symmetry) * kChunk;
      for (int i = 0; i < counts.count[symmetry]; ++i, weight += kChunk, ++sums) {
        for (int k = 0; k < positions; ++k) *sums += plane[k] * static_cast<double>(weight[k]);
      }
    }
  }
}

ProjectionDiagnostics diagnostics_of(std::span<const glm::dvec3> radiance, const SanitizeRecord& record,
                                     double steradians_per_weight) {
  ProjectionDiagnostics diagnostics;
  diagnostics.nans_replaced = record.nans;
  diagnostics.infinities_replaced = record.infinities;
  diagnostics.negatives_replaced = record.negatives;
  diagnostics.texels_clamped = record.clamped;
  // c(0,0) = Int L Y(0,0), and Y(0,0) = 1 / sqrt(4 pi).
  diagnostics.total_radiance = radiance.front() * (2.0 * std::sqrt(std::numbers::pi));
  diagnostics.total_radiance_before_clamp =
      diagnostics.total_radiance + record.radiance_removed * steradians_per_weight;
  return diagnostics;
}

}  // namespace welkin::projection

namespace welkin {
namespace {

// The public calls: arguments checked, the size chosen, the passes recorded.

class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void check_chain(std::span<const CubemapView> mips) {
  if (mips.empty()) throw Error(ErrorCode::invalid_argument, "the mip chain has no level");
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
  const Stopwatch reducing;
  const projection::ReducedCubemap reduced =
      projection::reduce_by_box(cubemap, target, options, jobs::part_of(control, 0.0, 0.6));
  const double milliseconds = reducing.milliseconds();
  ProjectionOptions whole = options;
  whole.quadrature = Quadrature::exact;
  const Projection exact = projection::project_cubemap(cubemap, whole, jobs::part_of(control, 0.6, 0.9));
  const Stopwatch projecting;
  Projection projection = projection::project_cubemap(reduced.view, options, jobs::part_of(control, 0.9, 1.0));
  projection::describe_projection(projection, target, options);
  projection.diagnostics.passes.back().milliseconds = projecting.milliseconds();
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
  const Stopwatch projecting;
  Projection projection = projection::project_cubemap(cubemap, options, control);
  projection::describe_projection(projection, cubemap.size, options);
  projection.diagnostics.passes.back().milliseconds = projecting.milliseconds();
  return projection;
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
  const Stopwatch projecting;
  const std::int64_t texels = std::int64_t{lat_long.width} * lat_long.height;
  const jobs::Placement placement = jobs::placement_for(texels);
  const std::size_t workers = jobs::worker_count(placement);
  projection::LatLongProjector projector(lat_long.width, lat_long.height, options, workers);
  const std::ptrdiff_t row_bytes = lat_long.row_stride_bytes != 0
                                       ? lat_long.row_stride_bytes
                                       : static_cast<std::ptrdiff_t>(bytes_per_texel(lat_long.format)) * lat_long.width;
  jobs::run_tiles(static_cast<std::size_t>(projector.block_count()), placement, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    const int block = static_cast<int>(tile);
                    const int first_row = block * projector.rows_per_block();
                    LatLongView rows = lat_long;
                    rows.pixels = static_cast<const std::byte*>(lat_long.pixels) + first_row * row_bytes;
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

}  // namespace welkin

namespace welkin::projection {
namespace {

constexpr double kRounding = 2e-7;

using BandNorms = std::array<double, kMaximumBands>;

/// |c_l| of each band, over orders and channels; returns those that there are.
std::span<const double> band_norms(std::span<const glm::dvec3> radiance, BandNorms& norms) {
  std::size_t bands = 0;
  for (std::size_t at = 0; at < radiance.size(); ++bands) {
    double sum = 0.0;
    for (const std::size_t end = (bands + 1) * (bands + 1); at < end; ++at) sum += glm::dot(radiance[at], radiance[at]);
    norms[bands] = std::sqrt(sum);
  }
  return {norms.data(), bands};
}

}  // namespace

double relative_error(std::span<const glm::dvec3> radiance, std::span<const glm::dvec3> exact, double beyond) {
  double exact_squared = 0.0;
  double off_squared = 0.0;
  for (std::size_t f = 0; f < radiance.size(); ++f) {
    const glm::dvec3 off = radiance[f] - exact[f];
    exact_squared += glm::dot(exact[f], exact[f]);
    off_squared += glm::dot(off, off);
  }
  const double lost = std::sqrt(off_squared) + beyond;
  if (exact_squared == 0.0) return lost > 0.0 ? 1.0 : 0.0;
  return kRounding + lost / std::sqrt(exact_squared);
}

double mip_error(std::span<const glm::dvec3> radiance, double size) {
  BandNorms room;
  const std::span<const double> norms = band_norms(radiance, room);
  double total_squared = 0.0;
  for (const double norm : norms) total_squared += norm * norm;
  if (total_squared == 0.0) return 0.0;
  double error_squared = 0.0;
  const auto add = [&](double error) { error_squared += error * error; };
  // Without a band 2 nothing is known of how concentrated the light is; band 1 is the next best witness.
  const std::size_t witness = std::min<std::size_t>(2, norms.size() - 1);
  const double point_norm = std::sqrt(2.0 * static_cast<double>(witness) + 1.0) * norms[0];
  const double point_share = norms[0] > 0.0 ? std::min(1.0, norms[witness] / point_norm) : 1.0;
  double varied_squared = 0.0;
  for (std::size_t band = 1; band < norms.size(); ++band) varied_squared += norms[band] * norms[band];
  add(0.45 * std::min(norms[0], 100.0 * std::sqrt(varied_squared)) / (size * size));
  const double cell = 0.5 * std::numbers::pi / size;
  for (std::size_t band = 1; band < norms.size(); ++band) {
    const auto l = static_cast<double>(band);
    add(l * (l + 1.0) * cell * cell / 7.0 * norms[band]);
    add(0.35 * l * cell * point_share * std::sqrt(2.0 * l + 1.0) * norms[0]);
  }
  return std::sqrt(error_squared / total_squared);
}

std::optional<int> effective_target(int size, const ProjectionOptions& options) noexcept {
  if (!options.target_size) return std::nullopt;
  const int target = options.quadrature == Quadrature::midpoint
                         ? static_cast<int>(std::bit_floor(static_cast<unsigned>(*options.target_size)))
                         : *options.target_size;
  return target < size ? std::optional(target) : std::nullopt;
}

// Of neighbours a > t > b the first is nearer if a / t < t / b.
std::size_t nearest_level(std::span<const int> sizes, int target) noexcept {
  std::size_t level = 0;
  while (level + 1 < sizes.size() && sizes[level] > target) {
    const std::int64_t a = sizes[level];
    const std::int64_t b = sizes[level + 1];
    const std::int64_t t = target;
    if (b <= t && a * b < t * t) break;
    ++level;
  }
  return level;
}

}  // namespace welkin::projection
