// Many cubemaps in one call: small ones side by side, each in one thread; large ones by all threads.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/many.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "projection/cubemap_projection.h"
#include "projection/project.h"
#include "projection/sanitizer.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {
namespace {

/// A tile ends with the probe that reaches this: some 25 microseconds, two probes of 64.
constexpr std::int64_t kTexelsPerTile = 49'152;

/// So many probes are more than a cache holds, as a rule.
constexpr std::size_t kMany = 16;

std::int64_t texels_of(const CubemapView& probe) { return std::int64_t{6} * probe.size * probe.size; }

}  // namespace

void add(ProjectionDiagnostics& sum, const ProjectionDiagnostics& one) {
  sum.texels += one.texels;
  sum.nans_replaced += one.nans_replaced;
  sum.infinities_replaced += one.infinities_replaced;
  sum.negatives_replaced += one.negatives_replaced;
  sum.texels_clamped += one.texels_clamped;
  sum.total_radiance_before_clamp += one.total_radiance_before_clamp;
  sum.total_radiance += one.total_radiance;
  sum.error_estimate = std::max(sum.error_estimate, one.error_estimate);
}

namespace {

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
      throw Error(ErrorCode::invalid_argument, "room for " + std::to_string(coefficients.size()) + " coefficients; " +
                                                   std::to_string(probes.size()) + " probes of " +
                                                   std::to_string(options.bands) + " bands have " +
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
    small_.make_rooms(workers);
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
    std::ranges::copy(projection.radiance.coefficients(), coefficients_of(k).begin());
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
