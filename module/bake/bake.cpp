// The passes of a bake: what each does, what it waits for, and how it is reported.
#include "welkin/bake.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bake/artefacts.h"
#include "bake/bake_plan.h"
#include "image/pixels.h"
#include "jobs/task_graph.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "projection/sanitized_pixels.h"
#include "reflections/brdf_table.h"
#include "reflections/prefilter.h"
#include "welkin/core.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace baking {
namespace {

/// The outcome of a pass that did not go as planned.
struct Outcome {
  PassAction action = PassAction::run;
  std::string reason{};
  double saved_milliseconds = 0.0;  ///< time to find a result, in the store's pass
};

/// Moves a result that a store found to the bake's result.
template <class Value, class Result>
std::optional<Outcome> take(Found<Value>& found, Result& result) {
  result = std::move(found.value);
  return Outcome{PassAction::reuse, found.where, found.milliseconds};
}

class Baking {
 public:
  /// `targets`: receive the cubemaps; null: they stay in the result.
  Baking(Source& source, const BakeOptions& options, const BakePlan& plan, ArtefactStore* store,
         const BakeTargets* targets, BakeResult& result)
      : source_(source), options_(options), plan_(plan), store_(store), targets_(targets), result_(result) {}

  void run(const Control& control) {
    if (targets_ != nullptr) list_targets();
    prepare_results();
    add_passes();
    add_stores();
    graph_.run(control);
    finish();
  }

 private:
  static constexpr std::size_t kSkipped = static_cast<std::size_t>(-1);
  using Work = std::optional<Outcome> (Baking::*)(const Control&);  ///< empty: as planned

  struct Step {
    Outcome outcome;
    std::size_t pass = kSkipped;  ///< index in the graph
  };

  /// Keeps parts of an older bake only where their memory can be reused.
  void prepare_results() {
    BakeResult fresh;
    if (plan_.background_size != 0) fresh.background = std::move(result_.background);
    if (options_.specular) fresh.specular = std::move(result_.specular);
    if (options_.irradiance) fresh.irradiance = std::move(result_.irradiance);
    result_ = std::move(fresh);
  }

  // The graph.

  [[nodiscard]] Work work_of(BakePass pass) const {
    switch (pass) {
      case BakePass::sanitize: return &Baking::sanitize;
      case BakePass::specular: return plan_.stored_specular ? &Baking::take_specular : &Baking::prefilter;
      case BakePass::background: return &Baking::fill_background;
      case BakePass::background_mips: return &Baking::fill_levels;
      case BakePass::project: return &Baking::project_source;
      case BakePass::irradiance: return &Baking::fill_irradiance;
      case BakePass::brdf: return &Baking::look_up_brdf;
      case BakePass::octahedral: break;
    }
    return &Baking::make_octahedral;
  }

  /// Adds a pass to the graph, weighted at least with the overhead of starting it.
  std::size_t add_pass(double weight, std::function<void(const Control&)> work, const std::vector<std::size_t>& after) {
    constexpr double kMinWeight = 10'000.0;  // nanoseconds
    return graph_.add(std::max(kMinWeight, weight), std::move(work), after);
  }

  /// Adds the passes that precede all others: reading the pixels, and finding stored results of them.
  void add_first_passes() {
    constexpr double kReadTexel = 10.0;  // nanoseconds, of a compressed file
    reading_ = source_.reading();
    if (reading_ && reading_->action != PassAction::skip) {
      read_ = add_pass(kReadTexel * static_cast<double>(source_.shape().texels()),
                       [this](const Control& control) { source_.read(control); }, {});
    }
    if (store_ == nullptr || !source_.holds_pixels()) return;
    constexpr double kHashed = 0.1;  // nanoseconds per byte
    const double bytes =
        static_cast<double>(source_.shape().texels()) * static_cast<double>(bytes_per_texel(source_.shape().format));
    find_ = add_pass(
        kHashed * bytes,
        [this](const Control& control) { found_ = store_->find(source_.pixels(), options_, plan_, control); },
        passes({read_}));
  }

  /// Returns the passes that exist.
  static std::vector<std::size_t> passes(std::vector<std::size_t> all) {
    std::erase(all, kSkipped);
    return all;
  }

  /// Adds the passes that the plan runs or reuses to the graph; those that it skips are only recorded.
  void add_passes() {
    add_first_passes();
    for (std::size_t k = 0; k < plan_.steps.size(); ++k) {
      const BakeStep& step = plan_.steps[k];
      const PlannedPass& planned = step.planned;
      steps_[k].outcome = {planned.action, planned.reason};
      if (planned.action == PassAction::skip) continue;
      std::vector<std::size_t> after;
      if (step.pass != BakePass::brdf) after = {read_, find_};
      for (const BakePass earlier : step.after) after.push_back(steps_[static_cast<std::size_t>(earlier)].pass);
      const Work work = work_of(step.pass);
      steps_[k].pass = add_pass(
          step.weight,
          [this, k, work](const Control& control) {
            if (auto outcome = (this->*work)(control)) steps_[k].outcome = std::move(*outcome);
          },
          passes(std::move(after)));
    }
  }

  // The passes.

  /// Returns whether a remaining computation needs sanitized pixels, or nothing else could describe the pixels.
  [[nodiscard]] bool wants_sanitized() const {
    if (find_ == kSkipped) return true;
    const bool specular = found_.missing_specular.has_value();
    const bool background = plan_.background_size > 0 && !found_.background;
    const bool irradiance = plan_.convolves() && !found_.irradiance;
    const bool described = plan_.runs(BakePass::project) || found_.sanitized;
    return specular || background || irradiance || !described;
  }

  std::optional<Outcome> sanitize(const Control& control) {
    if (!wants_sanitized()) return Outcome{PassAction::skip, "every result of the pixels was found in the cache"};
    sanitized_.emplace(source_.pixels(), options_.pixels, control);
    // A projection describes the pixels as well, and is kept itself.
    if (find_ != kSkipped && !plan_.runs(BakePass::project)) store_->keep(*sanitized_);
    if (sanitized_->bytes() == 0) return Outcome{PassAction::reuse, "source pixels are already valid RGB floats"};
    return Outcome{PassAction::run, "a copy as RGB floats, with the pixel policy applied"};
  }

  /// Returns what `work` makes of the sanitized pixels, a lat-long or a cubemap.
  template <class Function>
  auto of_sanitized(const Function& work) const {
    return sanitized_->cubemap() ? work(sanitized_->cube()) : work(sanitized_->lat_long());
  }

  std::optional<Outcome> fill_background(const Control& control) {
    if (found_.background) return take(*found_.background, result_.background);
    Cubemap older = std::move(result_.background).value_or(Cubemap());
    Cubemap& chain = result_.background.emplace(
        image::shaped(std::move(older), plan_.background_size, plan_.background_levels, control.memory));
    // A chain of huge values went through a scale and back, which loses very dark values.
    if (plan_.same_level && !(sanitized_ && reflections::safe_scale(*sanitized_) != 1.0F)) {
      copy_level(result_.specular->cubemap, chain, control);
    } else {
      reflections::fill_level(*sanitized_, chain, 0, control);
    }
    if (chain.levels() == 1) keep_background();
    return {};
  }

  void keep_background() {
    if (find_ != kSkipped && !plan_.stored_background) store_->keep_background(*result_.background);
  }

  /// Copies level 0 by tiles of rows, which follow one another in memory.
  static void copy_level(const Cubemap& from, Cubemap& to, const Control& control) {
    const std::ptrdiff_t values = std::ptrdiff_t{3} * from.size();
    const int tile_rows = std::max(1, (1 << 16) / (3 * from.size()));
    const auto placement = jobs::placement_for(std::int64_t{6} * from.size() * from.size());
    jobs::run_rows(6 * from.size(), tile_rows, placement, jobs::worker_count(placement), control,
                   [&](int row, std::size_t) {
                     std::copy_n(from.face(0, 0) + row * values, values, to.face(0, 0) + row * values);
                   });
  }

  std::optional<Outcome> fill_levels(const Control& control) {
    if (found_.background) return Outcome{PassAction::reuse, found_.background->where};
    if (plan_.stored_background && copy_stored_levels()) return {};
    fill_mips(*result_.background, options_.background->mip_filter, control);
    keep_background();
    if (plan_.stored_background) return Outcome{PassAction::run, "the source's own levels are not all finite"};
    return {};
  }

  /// Copies the levels below 0, which has passed all policies. Returns false, and copies none, if one is not finite.
  bool copy_stored_levels() {
    Cubemap& chain = *result_.background;
    const auto values = [&](int level) {
      const auto edge = static_cast<std::size_t>(chain.level_size(level));
      return std::span<const float>(source_.levels()->face(level, 0), 18 * edge * edge);
    };
    for (int level = 1; level < chain.levels(); ++level) {
      if (!platform::ranges::all_of(values(level), [](float value) { return std::isfinite(value); })) return false;
    }
    for (int level = 1; level < chain.levels(); ++level) platform::ranges::copy(values(level), chain.face(level, 0));
    return true;
  }

  std::optional<Outcome> take_specular(const Control& control) {
    result_.specular = source_.take_specular(control);
    return {};
  }

  std::optional<Outcome> prefilter(const Control& control) {
    if (find_ == kSkipped) {
      result_.specular = prefiltered(*plan_.prefilter, control);
      describe_pixels();
      return {};
    }
    std::optional<PrefilteredSpecular> made;
    if (found_.missing_specular) made = prefiltered(*found_.missing_specular, {control.stop, control.progress});
    result_.specular = store_->whole_specular(std::move(made));
    describe_pixels();
    if (found_.specular_where.empty()) return {};
    const char* const others = found_.missing_specular ? ", the others computed" : "";
    return Outcome{found_.missing_specular ? PassAction::run : PassAction::reuse, found_.specular_where + others,
                   found_.specular_milliseconds};
  }

  [[nodiscard]] PrefilteredSpecular prefiltered(const reflections::PrefilterPlan& mips, const Control& control) {
    Cubemap scratch = result_.specular ? std::move(result_.specular->cubemap) : Cubemap();
    if (!mips.irradiance || found_.irradiance) {
      reflections::PrefilterPlan without = mips;
      without.irradiance.reset();
      return reflections::prefilter(*sanitized_, without.without(0, 0), std::move(scratch), control);
    }
    return reflections::prefilter(*sanitized_, mips, std::move(scratch), control, &irradiance_.emplace());
  }

  /// Reports clean pixels: the input of the prefilter was sanitized before.
  void describe_pixels() {
    ProjectionDiagnostics clean;
    clean.texels = source_.shape().texels();
    reflections::describe_pixels(clean, {}, *result_.specular);
  }

  std::optional<Outcome> project_source(const Control& control) {
    if (takes_light()) {
      projection_ = Projection{resized(source_.take_radiance(control), options_.bands), {}};
      return {};
    }
    std::optional<Outcome> outcome;
    if (found_.projection) {
      outcome = take(*found_.projection, projection_);
    } else {
      projection_ =
          source_.holds_pixels() ? project(source_.pixels(), plan_.projecting, control) : streamed_projection(control);
      if (find_ != kSkipped) store_->keep(*projection_);
    }
    if (options_.bands > 0 && options_.bands < projection_->radiance.bands())
      projection_->radiance = resized(projection_->radiance, options_.bands);
    return outcome;
  }

  /// Returns whether the harmonics come with the source although it holds its pixels.
  [[nodiscard]] bool takes_light() const { return plan_.stored_harmonics && source_.holds_pixels(); }

  /// Projects a source that does not hold its pixels. It uses its stored harmonics unless they have too few bands.
  [[nodiscard]] Projection streamed_projection(const Control& control) {
    ProjectionOptions projecting = plan_.projecting;
    if (plan_.stored_harmonics) projecting.bands = options_.bands;
    return source_.project(projecting, control);
  }

  std::optional<Outcome> fill_irradiance(const Control& control) {
    std::optional<Outcome> outcome;
    if (found_.irradiance) {
      outcome = take(*found_.irradiance, irradiance_);
    } else {
      make_irradiance(control);
    }
    result_.irradiance = std::move(irradiance_->cubemap);
    result_.irradiance_record = irradiance_->record;
    return outcome;
  }

  void make_irradiance(const Control& control) {
    const int size = options_.irradiance->size;
    if (plan_.irradiance == IrradianceMethod::direct) {
      irradiance_ = reflections::integrated_irradiance(*sanitized_, size, control);
    } else if (plan_.irradiance == IrradianceMethod::harmonics) {
      irradiance_.emplace();
      irradiance_->cubemap = irradiance_cubemap(irradiance_from_radiance(projection_->radiance), size, control);
      irradiance_->record.size = size;
      irradiance_->record.method = MipMethod::spectral;
      irradiance_->record.bands = projection_->radiance.bands();
    } else if (!irradiance_) {
      irradiance_ = reflections::irradiance_cubemap(*sanitized_, *plan_.irradiance_plan, control);
    }
    // Irradiance of light that the source brought along is not determined by the pixels, and is not kept.
    if (find_ != kSkipped && (plan_.convolves() || !plan_.stored_harmonics)) store_->keep_irradiance(*irradiance_);
  }

  std::optional<Outcome> look_up_brdf(const Control& control) {
    bool made = false;
    result_.brdf = reflections::shared_brdf(*options_.brdf, control, made);
    if (made) return {};
    return Outcome{PassAction::reuse, "computed before; it does not depend on the environment"};
  }

  std::optional<Outcome> make_octahedral(const Control& control) {
    if (found_.octahedral) return take(*found_.octahedral, result_.octahedral);
    result_.octahedral = to_octahedral(result_.specular->cubemap, *plan_.octahedral, control);
    if (find_ != kSkipped && plan_.prefilter) store_->keep_octahedral(*result_.octahedral);
    return {};
  }

  // Writing to the caller's memory.

  /// A cubemap of the result that is written to targets, by a pass after the last one that changes it. Other passes may
  /// read it at the same time.
  struct Stored {
    const char* name;
    BakePass after;
    int size;  ///< 0 if there is none
    int levels;
    std::span<const CubemapTarget> targets;
    Cubemap& (*cubemap)(BakeResult&);
    std::size_t pass = kSkipped;
  };

  /// Checks the targets before anything is baked.
  void list_targets() {
    const auto add = [&](const char* what, const Stored& one) {
      if (one.targets.empty()) return;
      image::check_chain_targets(what, one.size, one.levels, one.targets);
      stored_.push_back(one);
    };
    const bool mips = plan_.background_levels > 1;
    const auto background = mips ? BakePass::background_mips : BakePass::background;
    add("background", {"store background", background, plan_.background_size, plan_.background_levels,
                       targets_->background, [](BakeResult& result) -> Cubemap& { return *result.background; }});
    const int levels = plan_.prefilter ? static_cast<int>(plan_.prefilter->mips.size()) : 0;
    const int size = levels > 0 ? plan_.prefilter->mips.front().size : 0;
    add("specular cubemap", {"store specular", BakePass::specular, size, levels, targets_->specular,
                             [](BakeResult& result) -> Cubemap& { return result.specular->cubemap; }});
    if (!targets_->irradiance) return;
    const auto& wanted = options_.irradiance;
    add("irradiance cubemap", {"store irradiance",
                               BakePass::irradiance,
                               wanted ? wanted->size : 0,
                               wanted ? 1 : 0,
                               {&*targets_->irradiance, 1},
                               [](BakeResult& result) -> Cubemap& { return *result.irradiance; }});
  }

  void add_stores() {
    constexpr double kTexelMilliseconds = 3e-6;
    for (Stored& one : stored_) {
      const auto work = [this, &one](const Control& control) {
        values_clamped_ += store_texels(one.cubemap(result_), one.targets, control);
      };
      one.pass = add_pass(kTexelMilliseconds * 6.0 * one.size * one.size, work,
                          passes({steps_[static_cast<std::size_t>(one.after)].pass}));
    }
  }

  /// Drops the cubemaps that went to targets: the caller has them.
  void drop_stored() {
    for (const Stored& one : stored_) {
      if (one.after == BakePass::irradiance) {
        result_.irradiance.reset();
      } else if (one.after == BakePass::specular) {
        result_.specular->cubemap = {};
      } else {
        result_.background.reset();
      }
    }
    result_.values_clamped = values_clamped_;
  }

  // Reporting.

  void finish() {
    ProjectionDiagnostics& diagnostics = result_.diagnostics;
    if (projection_) diagnostics = std::move(projection_->diagnostics);
    if (!projection_ || takes_light()) {
      if (sanitized_) {
        diagnostics = sanitized_->diagnostics();
      } else if (found_.sanitized) {
        diagnostics = std::move(*found_.sanitized);
      }
      diagnostics.texels = source_.shape().texels();
    }
    if (takes_light()) {
      diagnostics.total_radiance = projection_->radiance.at(0, 0) * std::sqrt(4.0 * std::numbers::pi);
      diagnostics.total_radiance_before_clamp = diagnostics.total_radiance;
    }
    if (options_.bands > 0) result_.radiance = std::move(projection_->radiance);
    result_.peak_bytes = plan_.result_bytes + plan_.working_bytes;
    record_passes(diagnostics.passes);
    drop_stored();
  }

  [[nodiscard]] double milliseconds_of(std::size_t pass) const {
    return pass == kSkipped ? 0.0 : graph_.milliseconds(pass);
  }

  void record_passes(std::vector<PassRecord>& records) {
    records.clear();
    if (reading_) records.push_back({reading_->name, reading_->action, reading_->reason, milliseconds_of(read_)});
    if (find_ != kSkipped) {
      double elsewhere = 0.0;
      for (const Step& step : steps_) elsewhere += step.outcome.saved_milliseconds;
      records.push_back({"hash", PassAction::run, "of the source, to look up earlier results",
                         std::max(0.0, milliseconds_of(find_) - elsewhere)});
    }
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      Outcome& outcome = steps_[k].outcome;
      records.push_back({plan_.steps[k].planned.name, outcome.action, std::move(outcome.reason),
                         outcome.saved_milliseconds + milliseconds_of(steps_[k].pass)});
    }
    for (const Stored& one : stored_) {
      records.push_back({one.name, PassAction::run, "to the caller's memory", milliseconds_of(one.pass)});
    }
  }

  Source& source_;
  const BakeOptions& options_;
  const BakePlan& plan_;
  ArtefactStore* store_;
  const BakeTargets* targets_;
  BakeResult& result_;

  jobs::TaskGraph graph_;
  std::optional<PlannedPass> reading_;
  std::size_t read_ = kSkipped;  ///< index in the graph, as `find_`
  std::size_t find_ = kSkipped;
  std::vector<Step> steps_ = std::vector<Step>(plan_.steps.size());  ///< in the plan's order
  std::vector<Stored> stored_;
  std::atomic<std::uint64_t> values_clamped_{0};

  FoundArtefacts found_;
  std::optional<reflections::IrradianceMap> irradiance_;
  std::optional<projection::SanitizedSource> sanitized_;
  std::optional<Projection> projection_;
};

/// Carries out a bake. `planned`: why the scene does not need a pass, where the bake does what was planned.
void carry_out(BakeResult& result, Source& source, const BakeOptions& options, ArtefactStore* store,
               const BakeTargets* targets, std::span<const PlannedPass> planned, const Control& control) {
  BakePlan plan = plan_bake(source.shape(), options, source.stored());
  require_memory(plan, options);
  for (BakeStep& step : plan.steps) {
    for (const PlannedPass& said : planned) {
      const bool same = said.name == step.planned.name && said.action == step.planned.action;
      if (same) step.planned.reason = said.reason;
    }
  }
  Baking(source, options, plan, store, targets, result).run(control);
}

[[noreturn]] void refuse(const char* what) {
  throw Error(ErrorCode::invalid_argument, std::string("the source of a bake provides no ") + what +
                                               "; this is an error in Welkin, please report it");
}

}  // namespace

Projection Source::project(const ProjectionOptions& /*options*/, const Control& /*control*/) { refuse("projection"); }
SphericalHarmonics Source::take_radiance(const Control& /*control*/) { refuse("coefficients"); }
PrefilteredSpecular Source::take_specular(const Control& /*control*/) { refuse("prefiltered chain"); }

void run_bake(BakeResult& result, Source& source, const BakeOptions& options, ArtefactStore* store,
              const Control& control) {
  carry_out(result, source, options, store, nullptr, {}, control);
}

BakeResult run_bake(Source& source, const Plan& planned, ArtefactStore* store, const Control& control) {
  if (const std::string words = source.description(); words != planned.source) {
    throw Error(ErrorCode::invalid_argument,
                "the plan is for " + planned.source + ", the source is " + words + "; plan again for this source");
  }
  BakeResult result;
  carry_out(result, source, planned.options, store, nullptr, planned.passes, control);
  return result;
}

}  // namespace baking

BakeOptions BakeOptions::at(Quality quality) {
  BakeOptions options;
  options.specular = PrefilterOptions::at(quality);
  // At errors below what harmonics can reach, irradiance is integrated.
  options.irradiance->rms_error = quality == Quality::reference ? 1e-6 : options.specular->rms_error;
  return options;
}

std::uint64_t bake_bytes(const EnvironmentView& source, const BakeOptions& options) {
  const platform::FloatingPointScope floating_point;
  const baking::BakePlan plan = baking::plan_bake(shape_of(source), options);
  return plan.result_bytes + plan.working_bytes;
}

void bake_into(BakeResult& result, const EnvironmentView& source, const BakeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource pixels(source);
  baking::run_bake(result, pixels, options, nullptr, control);
}

BakeResult bake(const EnvironmentView& source, const BakeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  BakeResult result;
  bake_into(result, source, options, control);
  return result;
}

BakeResult bake_to(const BakeTargets& targets, const EnvironmentView& source, const BakeOptions& options,
                   const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource pixels(source);
  BakeResult result;
  baking::carry_out(result, pixels, options, nullptr, &targets, {}, control);
  return result;
}

}  // namespace welkin
