// The passes of a bake: what each does, what it waits for, and what is said of it.
#include "welkin/bake.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "bake/bake_plan.h"
#include "brdf/brdf_table.h"
#include "image/pixels.h"
#include "jobs/task_graph.h"
#include "jobs/tiles.h"
#include "projection/sanitized_pixels.h"
#include "reflections/prefilter.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/resampling.h"

namespace welkin {
namespace baking {
namespace {

/// What a pass came to.
struct Outcome {
  std::string action = "run";
  std::string reason{};
};

template <class View>
class Baking {
 public:
  Baking(const View& source, const BakeOptions& options, const BakePlan& plan, const StoredResults& stored,
         BakeResult& result)
      : source_(source), shape_(shape_of(source)), options_(options), plan_(plan), stored_(stored), result_(result) {}

  void run(const Control& control) {
    prepare_results();
    add_passes();
    graph_.run(control);
    finish();
  }

 private:
  static constexpr std::size_t kSkipped = static_cast<std::size_t>(-1);
  using Work = Outcome (Baking::*)(const Control&);

  struct Step {
    Outcome outcome;
    std::size_t pass = kSkipped;  ///< of the graph
  };

  /// Makes room for the results, in what is there if it has the right size.
  void prepare_results() {
    result_.background = plan_.background_size == 0 ? CubemapChain()
                                                    : image::shaped(std::move(result_.background),
                                                                    plan_.background_size, plan_.background_levels);
    if (!options_.specular) result_.specular.reset();
    if (options_.irradiance_size == 0) result_.irradiance = {};
    result_.radiance.reset();
    result_.brdf.reset();
    result_.stored_polynomial.reset();
    result_.diagnostics = {};
    result_.peak_bytes = 0;
  }

  [[nodiscard]] Work work_of(BakePass pass) const {
    switch (pass) {
      case BakePass::sanitize: return &Baking::sanitize;
      case BakePass::specular: return plan_.stored_specular ? &Baking::take_specular : &Baking::prefilter;
      case BakePass::background: return &Baking::fill_background;
      case BakePass::background_mips: return &Baking::fill_levels;
      case BakePass::project: return &Baking::project_source;
      case BakePass::irradiance:
        return options_.irradiance_method == IrradianceMethod::direct ? &Baking::convolve_irradiance
                                                                      : &Baking::evaluate_irradiance;
      case BakePass::brdf: break;
    }
    return &Baking::look_up_brdf;
  }

  /// What the plan runs or reuses are passes of the graph; what it skips is only recorded.
  void add_passes() {
    constexpr double kLeastCost = 10'000.0;  // nanoseconds: what a pass takes to begin. Nothing would be no weight
    constexpr double kNanoseconds = 1e6;     // in a millisecond
    for (std::size_t k = 0; k < plan_.steps.size(); ++k) {
      const BakeStep& step = plan_.steps[k];
      const PlannedPass& planned = step.planned;
      steps_[k].outcome = {name(planned.action), planned.reason};
      if (planned.action == PassAction::skip) continue;
      std::vector<std::size_t> after;
      for (const BakePass earlier : step.after) {
        const std::size_t pass = steps_[static_cast<std::size_t>(earlier)].pass;
        if (pass != kSkipped) after.push_back(pass);
      }
      const Work work = work_of(step.pass);
      steps_[k].pass = graph_.add(
          std::max(kLeastCost, kNanoseconds * planned.predicted_milliseconds),
          [this, k, work](const Control& control) { steps_[k].outcome = (this->*work)(control); }, after);
    }
  }

  /// As planned.
  [[nodiscard]] Outcome done(BakePass pass) const {
    const PlannedPass& planned = plan_.step(pass).planned;
    return {name(planned.action), planned.reason};
  }

  Outcome sanitize(const Control& control) {
    sanitized_.emplace(source_, options_.pixels, control);
    if (sanitized_->bytes() == 0)
      return {"reuse", "the source's own pixels, looked through: they are clean RGB floats"};
    return {"run", "a copy as RGB floats, clamped and replaced as asked for"};
  }

  [[nodiscard]] const View& sanitized_view() const { return projection::view_of(*sanitized_, source_); }

  Outcome fill_background(const Control& control) {
    CubemapChain& chain = result_.background;
    const int size = chain.size();
    // A chain of huge values went through a scale and back, which loses what is very dark.
    if (plan_.same_level && !(sanitized_ && reflections::safe_scale(*sanitized_) != 1.0F)) {
      copy_level(result_.specular->cubemap, chain, control);
      return done(BakePass::background);
    }
    if constexpr (std::is_same_v<View, LatLongView>) {
      image::fill_cubemap(sanitized_view(), chain, ResampleFilter::area, control);
    } else {
      const CubemapImage image = to_cubemap(sanitized_view(), size, glm::dmat3(1.0), control);
      std::copy(image.pixels.begin(), image.pixels.end(), chain.face(0, 0));
    }
    return done(BakePass::background);
  }

  /// Level 0, a tile for some rows of all that lies one after the other in memory.
  static void copy_level(const CubemapChain& from, CubemapChain& to, const Control& control) {
    const std::size_t row = 3 * static_cast<std::size_t>(from.size());
    const std::size_t rows = 6 * static_cast<std::size_t>(from.size());
    const std::size_t tile_rows = std::max<std::size_t>(1, (std::size_t{1} << 16U) / row);
    const auto placement = jobs::placement_for(static_cast<std::int64_t>(rows * row / 3));
    jobs::run_tiles((rows + tile_rows - 1) / tile_rows, placement, jobs::worker_count(placement), control,
                    [&](std::size_t tile, std::size_t) {
                      const std::size_t first = tile * tile_rows;
                      const std::size_t count = std::min(tile_rows, rows - first);
                      std::memcpy(to.face(0, 0) + first * row, from.face(0, 0) + first * row,
                                  count * row * sizeof(float));
                    });
  }

  Outcome fill_levels(const Control& control) {
    if (plan_.stored_background && copy_stored_levels()) return done(BakePass::background_mips);
    fill_mips(result_.background, options_.mip_filter, control);
    if (plan_.stored_background) return {"run", "those that came with the pixels are not all finite"};
    return done(BakePass::background_mips);
  }

  /// Below level 0, which went through all the others' policies. False if some are no numbers: then nothing is copied.
  bool copy_stored_levels() {
    CubemapChain& chain = result_.background;
    const auto values = [&](int level) {
      const auto edge = static_cast<std::size_t>(chain.level_size(level));
      return std::span<const float>(stored_.levels->face(level, 0), 18 * edge * edge);
    };
    for (int level = 1; level < chain.levels(); ++level) {
      if (!std::ranges::all_of(values(level), [](float value) { return std::isfinite(value); })) return false;
    }
    for (int level = 1; level < chain.levels(); ++level) std::ranges::copy(values(level), chain.face(level, 0));
    return true;
  }

  Outcome take_specular(const Control& /*control*/) {
    result_.specular = std::move(*stored_.specular);
    return done(BakePass::specular);
  }

  Outcome prefilter(const Control& control) {
    PrefilterOptions prefiltering = *options_.specular;
    prefiltering.pixels = {};
    CubemapChain room = result_.specular ? std::move(result_.specular->cubemap) : CubemapChain();
    result_.specular = reflections::prefilter(sanitized_view(), prefiltering, 0, std::move(room), control).specular;
    return done(BakePass::specular);
  }

  Outcome project_source(const Control& control) {
    if (plan_.stored_harmonics) {
      projection_ = Projection{with_bands(*stored_.harmonics, options_.bands), {}};
    } else {
      projection_ = project(source_, plan_.projecting, control);
      if (options_.bands > 0 && options_.bands < plan_.projecting.bands)
        projection_->radiance = with_bands(projection_->radiance, options_.bands);
    }
    return done(BakePass::project);
  }

  Outcome evaluate_irradiance(const Control& control) {
    const SphericalHarmonics irradiance = irradiance_from_radiance(projection_->radiance);
    result_.irradiance = irradiance_cubemap(irradiance, options_.irradiance_size, control);
    return done(BakePass::irradiance);
  }

  Outcome convolve_irradiance(const Control& control) {
    result_.irradiance = direct_irradiance_cubemap(sanitized_view(), options_.irradiance_size, control);
    return done(BakePass::irradiance);
  }

  Outcome look_up_brdf(const Control& control) {
    bool made = false;
    result_.brdf = brdf::shared_brdf(*options_.brdf, control, made);
    if (made) return done(BakePass::brdf);
    return {"reuse", "made before: it depends on no scene"};
  }

  void finish() {
    ProjectionDiagnostics& diagnostics = result_.diagnostics;
    if (projection_) diagnostics = std::move(projection_->diagnostics);
    if (!projection_ || plan_.stored_harmonics) {
      if (sanitized_) diagnostics = sanitized_->diagnostics();
      diagnostics.texels = shape_.texels();
    }
    if (plan_.stored_harmonics) {
      diagnostics.total_radiance = stored_.harmonics->at(0, 0) * std::sqrt(4.0 * std::numbers::pi);
      diagnostics.total_radiance_before_clamp = diagnostics.total_radiance;
    }
    diagnostics.passes.clear();
    if (options_.bands > 0) result_.radiance = std::move(projection_->radiance);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      Step& step = steps_[k];
      diagnostics.passes.push_back({plan_.steps[k].planned.name, std::move(step.outcome.action),
                                    std::move(step.outcome.reason),
                                    step.pass == kSkipped ? 0.0 : graph_.milliseconds(step.pass)});
    }
    result_.peak_bytes = plan_.result_bytes + plan_.working_bytes;
  }

  const View& source_;
  SourceShape shape_;
  const BakeOptions& options_;
  const BakePlan& plan_;
  const StoredResults& stored_;
  BakeResult& result_;
  jobs::PassGraph graph_;
  std::vector<Step> steps_ = std::vector<Step>(plan_.steps.size());  ///< in the plan's order
  std::optional<projection::SanitizedSource> sanitized_;
  std::optional<Projection> projection_;
};

template <class View>
std::uint64_t bytes_of(const View& source, const BakeOptions& options) {
  const BakePlan plan = plan_bake(shape_of(source), options);
  return plan.result_bytes + plan.working_bytes;
}

/// A plan knows why the scene needs none of it, or what its error budget picked.
void take_reasons(std::span<const PlannedPass> planned, BakePlan& plan) {
  for (BakeStep& step : plan.steps) {
    for (const PlannedPass& said : planned) {
      const bool same = said.name == step.planned.name && said.action == step.planned.action;
      if (same) step.planned.reason = said.reason;
    }
  }
}

template <class View>
void bake_view(BakeResult& result, const View& source, const BakeOptions& options, const StoredResults& stored,
               std::span<const PlannedPass> planned, const Control& control) {
  BakePlan plan = plan_bake(shape_of(source), options, stored.kinds());
  require_memory(plan.result_bytes, plan.working_bytes, options);
  take_reasons(planned, plan);
  Baking<View>(source, options, plan, stored, result).run(control);
}

}  // namespace

StoredKinds StoredResults::kinds() const noexcept {
  StoredKinds kinds;
  if (harmonics != nullptr) kinds.harmonics_bands = harmonics->bands();
  if (specular != nullptr) {
    kinds.specular_mips = specular->cubemap.levels();
    kinds.specular_size = specular->cubemap.size();
  }
  if (levels != nullptr) kinds.background_levels = levels->levels();
  return kinds;
}

void bake_source(BakeResult& result, const CubemapView& source, const BakeOptions& options, const StoredResults& stored,
                 std::span<const PlannedPass> planned, const Control& control) {
  bake_view(result, source, options, stored, planned, control);
}

void bake_source(BakeResult& result, const LatLongView& source, const BakeOptions& options, const StoredResults& stored,
                 std::span<const PlannedPass> planned, const Control& control) {
  bake_view(result, source, options, stored, planned, control);
}

}  // namespace baking

std::uint64_t bake_bytes(const LatLongView& source, const BakeOptions& options) {
  return baking::bytes_of(source, options);
}

std::uint64_t bake_bytes(const CubemapView& source, const BakeOptions& options) {
  return baking::bytes_of(source, options);
}

void bake_into(BakeResult& result, const LatLongView& source, const BakeOptions& options, const Control& control) {
  baking::bake_source(result, source, options, {}, {}, control);
}

void bake_into(BakeResult& result, const CubemapView& source, const BakeOptions& options, const Control& control) {
  baking::bake_source(result, source, options, {}, {}, control);
}

BakeResult bake(const LatLongView& source, const BakeOptions& options, const Control& control) {
  BakeResult result;
  bake_into(result, source, options, control);
  return result;
}

BakeResult bake(const CubemapView& source, const BakeOptions& options, const Control& control) {
  BakeResult result;
  bake_into(result, source, options, control);
  return result;
}

}  // namespace welkin
