// Many cubemaps in one call: small ones side by side, each in one thread; large ones by all threads.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/many.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "projection/chunk_projection.h"
#include "projection/cubemap_projection.h"
#include "projection/midpoint_error.h"
#include "projection/projection_error.h"
#include "projection/sanitizer.h"
#include "projection/strip_projection.h"
#include "projection/target_size.h"
#include "projection/texel_weights.h"
#include "projection/tile_sums.h"
#include "transform/frame_transform.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {
namespace {

/// A tile ends with the probe that reaches this: some 25 microseconds, two probes of 64.
constexpr std::int64_t kTexelsPerTile = 49'152;

/// So many probes are more than a cache holds, as a rule.
constexpr std::size_t kMany = 16;

std::int64_t texels_of(int size) { return std::int64_t{6} * size * size; }
std::int64_t texels_of(const CubemapView& probe) { return texels_of(probe.size); }

/// Small cubemaps: each is projected whole by one thread, with the bits of `project`, and without the heap.
///
/// Name the sizes that occur (`prepare`), then say how many threads there are (`make_scratch`), then project.
class SmallCubemaps {
 public:
  /// `one_of_many`: most pixels must come from memory, and are asked for ahead.
  SmallCubemaps(const ProjectionOptions& options, bool one_of_many)
      : options_(options), sanitizer_(options.pixels), one_of_many_(one_of_many) {
    options_.target_size.reset();  // of those that they take it is none
    // Shared tables are built here, not inside a tile.
    for (const int face : kAllFaces) static_cast<void>(transforms::face_transform(face, options.bands));
  }

  /// Whether they take cubemaps of that size: those that `project` itself leaves to the calling thread, but for
  /// those that are reduced, which need memory of their own.
  [[nodiscard]] static bool serves(int size, const ProjectionOptions& options) noexcept {
    if (effective_target(size, options)) return false;
    return jobs::placement_for(texels_of(size)) == jobs::Placement::calling_thread &&
           !StripProjection::serves(size, options);
  }

  void prepare(int size) {
    const auto at = static_cast<std::size_t>(size);
    if (weights_.size() <= at) weights_.resize(at + 1);
    errors_.resize(weights_.size());
    if (weights_[at]) return;
    weights_[at] = TexelWeights::get(weights_key(size, options_));
    if (options_.quadrature == Quadrature::midpoint)
      errors_[at] = MidpointError::get(size, options_.bands, *weights_[at]);
  }

  void make_scratch(std::size_t workers) {
    std::size_t weight_floats = 0;
    for (const auto& weights : weights_) weight_floats = std::max(weight_floats, weights ? weights->scratch_size() : 0);
    scratches_.clear();
    scratches_.reserve(workers);
    while (scratches_.size() < workers) scratches_.emplace_back(options_.bands * options_.bands, weight_floats);
  }

  /// Writes bands^2 coefficients. A texel that a policy rejects is left in `record`. Different workers may project at
  /// the same time. Allocates nothing.
  [[nodiscard]] ProjectionDiagnostics project(const CubemapView& cubemap, std::size_t worker, std::span<dvec3> radiance,
                                              SanitizeRecord& record) {
    Scratch& scratch = scratches_[worker];
    const TexelWeights& weights = *weights_[static_cast<std::size_t>(cubemap.size)];
    const ChunkProjection chunks(cubemap, options_, kAllFaces, sanitizer_, weights, one_of_many_);
    const MidpointError* const error = errors_[static_cast<std::size_t>(cubemap.size)].get();
    std::fill(scratch.sums.begin(), scratch.sums.end(), 0.0);
    std::fill(scratch.off.begin(), scratch.off.end(), 0.0);
    for (int tile = 0; tile < ChunkProjection::tile_count(weights); ++tile) {
      record.add(add_tile(chunks, tile, weights.weight_rows().data(), error, scratch));
    }
    const std::size_t functions = radiance.size();
    const auto at = [functions](const std::vector<double>& sums, std::size_t f) {
      return dvec3(sums[f], sums[functions + f], sums[2 * functions + f]);
    };
    for (std::size_t f = 0; f < functions; ++f) radiance[f] = at(scratch.sums, f);
    ProjectionDiagnostics diagnostics = cubemap_diagnostics(cubemap.size, radiance, record);
    diagnostics.error_estimate = relative_error(radiance, radiance);
    if (error == nullptr) return diagnostics;
    std::array<dvec3, std::size_t{kMaximumBands} * kMaximumBands> off;
    for (std::size_t f = 0; f < functions; ++f) off[f] = at(scratch.off, f);
    diagnostics.error_estimate = midpoint_estimate(radiance, {off.data(), functions}, *error);
    return diagnostics;
  }

 private:
  /// What a worker needs.
  struct Scratch {
    Scratch(int functions, std::size_t weight_floats)
        : chunks(functions, weight_floats),
          slot(static_cast<std::size_t>(3 * functions)),
          sums(slot.size()),
          off_slot(slot.size()),
          off(slot.size()) {}

    ChunkProjection::Scratch chunks;
    std::vector<double> slot;      ///< of a tile, [3][functions]
    std::vector<double> sums;      ///< of all, likewise
    std::vector<double> off_slot;  ///< what the midpoint rule errs by in a tile
    std::vector<double> off;       ///< and in all
  };

  SanitizeRecord add_tile(const ChunkProjection& chunks, int tile, const int* weight_rows, const MidpointError* error,
                          Scratch& scratch) const {
    std::fill(scratch.slot.begin(), scratch.slot.end(), 0.0);
    std::fill(scratch.off_slot.begin(), scratch.off_slot.end(), 0.0);
    SanitizeRecord of_tile;
    chunks.sum_tile(tile, scratch.chunks);
    for (const int face : kAllFaces) {
      SanitizeRecord of_face;
      const std::span<const double> sums = chunks.face_sums(tile, face, scratch.chunks, of_face);
      transforms::face_transform(face, options_.bands).add(sums.data(), weight_rows, scratch.slot.data());
      if (error != nullptr) error->add(face, sums.data(), scratch.off_slot.data());
      of_tile.add(of_face);
    }
    for (std::size_t k = 0; k < scratch.sums.size(); ++k) {
      scratch.sums[k] += scratch.slot[k];
      scratch.off[k] += scratch.off_slot[k];
    }
    return of_tile;
  }

  ProjectionOptions options_;
  Sanitizer sanitizer_;
  bool one_of_many_;
  std::vector<std::shared_ptr<const TexelWeights>> weights_;  ///< by size
  std::vector<std::shared_ptr<const MidpointError>> errors_;  ///< by size, of the midpoint rule
  std::vector<Scratch> scratches_;                            ///< of each worker
};

/// Probes that follow each other and are projected in one tile; or one large probe.
struct Group {
  std::size_t first = 0;
  std::size_t end = 0;
  ProjectionDiagnostics diagnostics{};
};

class ManyProjections {
  using Clock = std::chrono::steady_clock;

 public:
  ManyProjections(std::span<const CubemapView> probes, std::span<dvec3> coefficients, const ProjectionOptions& options)
      : probes_(probes),
        coefficients_(coefficients),
        options_(options),
        functions_(static_cast<std::size_t>(options.bands) * static_cast<std::size_t>(options.bands)),
        small_(options, probes.size() >= kMany) {
    if (coefficients.size() / functions_ < probes.size()) {
      throw Error(ErrorCode::invalid_argument, "coefficients has " + std::to_string(coefficients.size()) +
                                                   " elements; " + std::to_string(probes.size()) + " probes of " +
                                                   std::to_string(options.bands) + " bands need " +
                                                   std::to_string(functions_ * probes.size()));
    }
    for (std::size_t k = 0; k < probes.size(); ++k) {
      jobs::naming_probe(k, [&] { image::check_view(probes[k]); });
    }
  }

  ProjectionDiagnostics run(const Control& control) {
    const Clock::time_point began = Clock::now();
    gather();
    const double small_share = static_cast<double>(small_texels_) /
                               static_cast<double>(std::max<std::int64_t>(1, small_texels_ + large_texels_));
    run_small(jobs::part_of(control, 0.0, small_share));
    run_large(control, small_share);
    rejection_.throw_if_any();
    ProjectionDiagnostics sum;
    for (const Group& group : groups_) add(sum, group.diagnostics);
    for (const Group& group : large_) add(sum, group.diagnostics);
    sum.passes.push_back({"project", PassAction::run, std::to_string(probes_.size()) + " cubemaps",
                          std::chrono::duration<double, std::milli>(Clock::now() - began).count()});
    return sum;
  }

 private:
  static bool is_large(const CubemapView& probe) {
    return jobs::placement_for(texels_of(probe)) != jobs::Placement::calling_thread;
  }

  /// Tiles follow from the sizes alone.
  void gather() {
    std::int64_t texels = kTexelsPerTile;  // of the last group: the first probe begins one
    for (std::size_t k = 0; k < probes_.size(); ++k) {
      const CubemapView& probe = probes_[k];
      if (is_large(probe)) {
        large_.push_back({k, k + 1});
        large_texels_ += texels_of(probe);
        texels = kTexelsPerTile;
        continue;
      }
      if (SmallCubemaps::serves(probe.size, options_)) small_.prepare(probe.size);
      if (texels >= kTexelsPerTile) {
        groups_.push_back({k, k});
        texels = 0;
      }
      groups_.back().end = k + 1;
      texels += texels_of(probe);
      small_texels_ += texels_of(probe);
    }
  }

  void run_small(const Control& control) {
    const jobs::Placement placement = jobs::placement_for(small_texels_);
    const std::size_t workers = jobs::worker_count(placement);
    small_.make_scratch(workers);
    jobs::run_tiles(groups_.size(), placement, workers, control,
                    [&](std::size_t tile, std::size_t worker) { project_group(groups_[tile], worker, control); });
  }

  void project_group(Group& group, std::size_t worker, const Control& control) {
    for (std::size_t k = group.first; k < group.end; ++k) {
      rejection_.guard(k, [&] { add(group.diagnostics, project_small(k, worker, control)); });
    }
  }

  ProjectionDiagnostics project_small(std::size_t k, std::size_t worker, const Control& control) {
    if (!SmallCubemaps::serves(probes_[k].size, options_)) return project_alone(k, {control.stop});
    SanitizeRecord record;
    ProjectionDiagnostics diagnostics = small_.project(probes_[k], worker, coefficients_of(k), record);
    throw_if_rejected(record, true);
    return diagnostics;
  }

  void run_large(const Control& control, double from) {
    std::int64_t done = 0;
    for (Group& group : large_) {
      const auto share = [&](std::int64_t texels) {
        return texels == large_texels_
                   ? 1.0
                   : from + (1.0 - from) * static_cast<double>(texels) / static_cast<double>(large_texels_);
      };
      const double begin = share(done);
      done += texels_of(probes_[group.first]);
      const Control part = jobs::part_of(control, begin, share(done));
      rejection_.guard(group.first, [&] { group.diagnostics = project_alone(group.first, part); });
    }
  }

  ProjectionDiagnostics project_alone(std::size_t k, const Control& control) {
    Projection projection = project(probes_[k], options_, control);
    platform::ranges::copy(projection.radiance.coefficients(), coefficients_of(k).begin());
    return std::move(projection.diagnostics);
  }

  [[nodiscard]] std::span<dvec3> coefficients_of(std::size_t k) const {
    return coefficients_.subspan(functions_ * k, functions_);
  }

  std::span<const CubemapView> probes_;
  std::span<dvec3> coefficients_;
  const ProjectionOptions& options_;
  std::size_t functions_;
  SmallCubemaps small_;
  std::vector<Group> groups_;  ///< of small probes
  std::vector<Group> large_;
  std::int64_t small_texels_ = 0;
  std::int64_t large_texels_ = 0;
  jobs::FirstRejection rejection_;
};

}  // namespace
}  // namespace welkin::projection

namespace welkin {

ProjectionDiagnostics project_many(std::span<const CubemapView> probes, std::span<dvec3> coefficients,
                                   const ProjectionOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  projection::check_options(options);
  return projection::ManyProjections(probes, coefficients, options).run(control);
}

}  // namespace welkin
