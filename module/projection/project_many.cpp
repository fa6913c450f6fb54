// Many cubemaps in one call: small ones side by side, each in one thread; large ones by all threads.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
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
#include "projection/projection_error.h"
#include "projection/sanitizer.h"
#include "projection/strip_projection.h"
#include "projection/tile_sums.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {
namespace {

/// A tile ends with the probe that reaches this: some 25 microseconds, two probes of 64.
constexpr std::int64_t kTexelsPerTile = 49'152;

/// So many probes usually exceed the cache.
constexpr std::size_t kMany = 16;

std::int64_t texels_of(int size) { return std::int64_t{6} * size * size; }
std::int64_t texels_of(const CubemapView& probe) { return texels_of(probe.size); }

/// Small cubemaps: each is projected whole by one thread, bit for bit as by `project`, and without the heap.
///
/// Name the sizes that occur (`prepare`), then say how many threads there are (`make_scratch`), then project.
class SmallCubemaps {
 public:
  /// `one_of_many`: most pixels must come from memory, and are prefetched.
  SmallCubemaps(const ProjectionOptions& options, bool one_of_many)
      : options_(options), sanitizer_(options.pixels), one_of_many_(one_of_many) {
    options_.target_size.reset();  // of those that they take it is none
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
    if (tables_.size() <= at) tables_.resize(at + 1);
    if (!tables_[at]) tables_[at].emplace(size, options_);
  }

  void make_scratch(std::size_t workers) {
    std::size_t weight_floats = 0;
    int tiles = 0;
    for (const auto& tables : tables_) {
      if (!tables) continue;
      weight_floats = std::max(weight_floats, tables->weights->scratch_size());
      tiles = std::max(tiles, ChunkProjection::tile_count(*tables->weights));
    }
    scratches_.clear();
    scratches_.reserve(workers);
    while (scratches_.size() < workers)
      scratches_.push_back(
          {{options_.bands * options_.bands, weight_floats}, {static_cast<std::size_t>(tiles), options_}});
  }

  /// Writes bands^2 coefficients. Different workers may project at the same time. Allocates nothing. Throws `Error`
  /// (rejected_pixel).
  [[nodiscard]] ProjectionDiagnostics project(const CubemapView& cubemap, std::size_t worker,
                                              std::span<dvec3> radiance) {
    auto& [chunk_scratch, sums] = scratches_[worker];
    const CubemapTables& tables = *tables_[static_cast<std::size_t>(cubemap.size)];
    const ChunkProjection chunks(cubemap, options_, kAllFaces, sanitizer_, *tables.weights, one_of_many_);
    sums.clear();
    for (int tile = 0; tile < ChunkProjection::tile_count(*tables.weights); ++tile) {
      chunks.sum_tile(tile, chunk_scratch);
      for (const int face : kAllFaces) {
        SanitizeRecord record;
        const std::span<const double> face_sums = chunks.face_sums(tile, face, chunk_scratch, record);
        sums.add(tables, static_cast<std::size_t>(tile), face, face_sums.data(), record);
      }
    }
    return sums.finish(tables, radiance);
  }

 private:
  /// One worker's scratch.
  struct Scratch {
    ChunkProjection::Scratch chunks;
    WorldSums sums;
  };

  ProjectionOptions options_;
  Sanitizer sanitizer_;
  bool one_of_many_;
  std::vector<std::optional<CubemapTables>> tables_;  ///< by size
  std::vector<Scratch> scratches_;                    ///< of each worker
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
    return small_.project(probes_[k], worker, coefficients_of(k));
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
