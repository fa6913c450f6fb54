// Many probes in one call: small ones concurrently, each on one thread; large ones on all threads.
#include <algorithm>
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
#include "jobs/stopwatch.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "projection/sanitizer.h"
#include "projection/tile_sums.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_plan.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace welkin {
namespace baking {
namespace {

std::int64_t texels_of(const CubemapView& probe) { return std::int64_t{6} * probe.size * probe.size; }

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

class ManyBakes {
 public:
  ManyBakes(std::span<const CubemapView> probes, std::span<const CubemapTarget> specular, std::span<dvec3> coefficients,
            const PrefilterOptions& options, int bands)
      : probes_(probes),
        specular_(specular),
        coefficients_(coefficients),
        plan_(reflections::plan_prefilter(options)),
        pixels_(options.pixels),
        projecting_{.bands = std::max(1, bands), .pixels = options.pixels},
        functions_(static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands)),
        made_(probes.size()) {
    const std::size_t mips = plan_.mips.size();
    if (specular.size() != mips * probes.size()) {
      refuse("there are " + std::to_string(specular.size()) + " targets for " + std::to_string(probes.size()) +
             " chains of " + std::to_string(mips) + " mips; pass " + std::to_string(mips * probes.size()));
    }
    if (coefficients.size() < functions_ * probes.size()) {
      refuse("coefficients has " + std::to_string(coefficients.size()) + " elements for " +
             std::to_string(probes.size()) + " probes of " + std::to_string(bands) + " bands; pass " +
             std::to_string(functions_ * probes.size()));
    }
    for (std::size_t k = 0; k < probes.size(); ++k) {
      jobs::naming_probe(k, [&] {
        image::check_view(probes[k]);
        image::check_chain_targets("specular cubemap", options.size, static_cast<int>(mips), targets_of(k));
      });
    }
  }

  BakeResult run(const Control& control) {
    const jobs::Stopwatch watch;
    gather();
    make_tables(control);
    const double beside_share = share_of(beside_texels_);
    run_beside(jobs::part_of(control, 0.0, beside_share));
    std::int64_t done = beside_texels_;
    for (const std::size_t k : one_by_one_) {
      const double from = share_of(done);
      done += texels_of(probes_[k]);
      const Control part = jobs::part_of(control, from, share_of(done));
      rejection_.guard(k, [&] { bake_probe(k, 0, part); });
    }
    rejection_.throw_if_any();
    BakeResult result;
    for (const Made& one : made_) {
      projection::add(result.diagnostics, one.diagnostics);
      result.values_clamped += one.values_clamped;
      result.peak_bytes = std::max(result.peak_bytes, one.peak_bytes);
    }
    result.peak_bytes *= scratch_.size();
    result.diagnostics.passes.push_back(
        {"specular", PassAction::run, std::to_string(probes_.size()) + " cubemaps", watch.milliseconds()});
    return result;
  }

 private:
  /// The outcome of a probe.
  struct Made {
    ProjectionDiagnostics diagnostics{};
    std::uint64_t values_clamped = 0;
    std::uint64_t peak_bytes = 0;
  };

  [[nodiscard]] double share_of(std::int64_t texels) const {
    if (texels >= all_texels_) return 1.0;
    return static_cast<double>(texels) / static_cast<double>(all_texels_);
  }

  /// Bakes small probes concurrently if there are enough of them for all threads. The bits do not depend on that: a
  /// probe is baked in the same way by one thread or by many.
  void gather() {
    const std::size_t threads = jobs::worker_count(jobs::Placement::arena);
    const auto is_small = [](const CubemapView& probe) {
      return jobs::placement_for(texels_of(probe)) == jobs::Placement::calling_thread;
    };
    const bool enough = static_cast<std::size_t>(platform::ranges::count_if(probes_, is_small)) >= 2 * threads;
    for (std::size_t k = 0; k < probes_.size(); ++k) {
      const bool goes_beside = enough && is_small(probes_[k]);
      (goes_beside ? beside_ : one_by_one_).push_back(k);
      (goes_beside ? beside_texels_ : one_by_one_texels_) += texels_of(probes_[k]);
    }
    all_texels_ = beside_texels_ + one_by_one_texels_;
    scratch_.resize(beside_.empty() ? 1 : threads);
  }

  /// Makes the tables on all threads: probes that bake concurrently would all wait for the one that makes them.
  void make_tables(const Control& control) const {
    int last = 0;  // usually all probes have one size, and repeated calls are cheap
    for (const std::size_t k : beside_) {
      const int size = probes_[k].size;
      if (size != std::exchange(last, size)) reflections::make_tables(plan_, size, control);
    }
  }

  void run_beside(const Control& control) {
    jobs::run_tiles(beside_.size(), jobs::Placement::arena, scratch_.size(), control,
                    [&](std::size_t tile, std::size_t worker) {
                      const jobs::OneThread alone;
                      rejection_.guard(beside_[tile], [&] { bake_probe(beside_[tile], worker, {control.stop}); });
                    });
  }

  void bake_probe(std::size_t k, std::size_t worker, const Control& control) {
    constexpr double kProjected = 0.05;
    Made& made = made_[k];
    Projection light = project(probes_[k], projecting_, jobs::part_of(control, 0.0, kProjected));
    if (functions_ > 0) platform::ranges::copy(light.radiance.coefficients(), coefficients_.begin() + offset(k));
    made.diagnostics = std::move(light.diagnostics);
    made.diagnostics.passes = {};

    PrefilteredSpecular chain = reflections::prefilter(probes_[k], plan_, pixels_, std::move(scratch_[worker]),
                                                       jobs::part_of(control, kProjected, 0.95));
    made.values_clamped = store_texels(chain.cubemap, targets_of(k), jobs::part_of(control, 0.95, 1.0));
    made.peak_bytes = chain.peak_bytes + chain.cubemap.bytes();
    scratch_[worker] = std::move(chain.cubemap);
  }

  [[nodiscard]] std::span<const CubemapTarget> targets_of(std::size_t k) const {
    return specular_.subspan(k * plan_.mips.size(), plan_.mips.size());
  }
  [[nodiscard]] std::ptrdiff_t offset(std::size_t k) const { return static_cast<std::ptrdiff_t>(functions_ * k); }

  std::span<const CubemapView> probes_;
  std::span<const CubemapTarget> specular_;
  std::span<dvec3> coefficients_;
  reflections::PrefilterPlan plan_;  ///< of all probes
  PixelPolicy pixels_;
  ProjectionOptions projecting_;
  std::size_t functions_;
  std::vector<Made> made_;
  std::vector<std::size_t> beside_;
  std::vector<std::size_t> one_by_one_;
  std::int64_t beside_texels_ = 0;
  std::int64_t one_by_one_texels_ = 0;
  std::int64_t all_texels_ = 0;
  std::vector<Cubemap> scratch_;  ///< per worker: the chain before it is stored to its targets
  jobs::FirstRejection rejection_;
};

}  // namespace
}  // namespace baking

BakeResult bake_many(std::span<const CubemapView> probes, std::span<const CubemapTarget> specular,
                     std::span<dvec3> coefficients, const PrefilterOptions& options, int bands,
                     const Control& control) {
  const platform::FloatingPointScope floating_point;
  if (bands < 0 || bands > kMaximumBands) {
    baking::refuse("bands is " + std::to_string(bands) + "; it must be from 0 to " + std::to_string(kMaximumBands));
  }
  return baking::ManyBakes(probes, specular, coefficients, options, bands).run(control);
}

}  // namespace welkin
