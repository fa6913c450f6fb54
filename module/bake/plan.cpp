// Plans for people.
#include "welkin/plan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "bake/artefacts.h"
#include "bake/bake_plan.h"
#include "bake/needs.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/irradiance.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace baking {
namespace {

BakeResult bake_planned(const PixelsView& pixels, const Plan& plan, const Control& control) {
  MemorySource source(pixels);
  return run_bake(source, plan, nullptr, control);
}

template <class View>
Plan plan_view(const View& view, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs,
               const Control& control) {
  check(needs);
  const SourceShape source = welkin::shape_of(view);
  NeededOptions needed = needed_options(source, needs, whole);
  if (needs.error_budget) spend_budget(view, *needs.error_budget, needed, control);
  return plan_pixels(source, needed, {}, costs);
}

}  // namespace

Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const StoredKinds& stored,
                 const CostModel& costs) {
  const BakePlan baking = plan_bake(source, needed.options, needed.trim, stored, costs);
  Plan plan;
  plan.source = source.words();
  plan.options = needed.options;
  plan.trim = needed.trim;
  plan.take_specular = baking.stored_specular;
  plan.take_levels = baking.stored_background;
  plan.take_light = baking.stored_harmonics;
  plan.result_bytes = baking.result_bytes;
  plan.working_bytes = baking.working_bytes;
  for (const BakeStep& step : baking.steps) {
    PlannedPass& pass = plan.passes.emplace_back(step.planned);
    const bool skipped = pass.action == PassAction::skip;
    if (skipped && needed.left_out.contains(step.pass)) pass.reason = needed.left_out.at(step.pass);
    if (!skipped && needed.chosen.contains(step.pass)) pass.reason += "; " + needed.chosen.at(step.pass);
  }
  return plan;
}

}  // namespace baking

double Plan::milliseconds(int threads) const noexcept {
  const platform::FloatingPointScope floating_point;
  double sum = 0.0;
  for (const PlannedPass& pass : passes) sum += pass.predicted_milliseconds;
  return sum / std::max(1, threads);
}

const PlannedPass& Plan::pass(const std::string& name) const {
  const auto found = platform::ranges::find(passes, name, &PlannedPass::name);
  if (found == passes.end()) throw Error(ErrorCode::invalid_argument, "the plan has no pass called " + name);
  return *found;
}

Plan plan(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs) {
  const platform::FloatingPointScope floating_point;
  check(needs);
  baking::refuse_budget(needs, "plan the view of the pixels instead of their shape");
  return baking::plan_pixels(source, baking::needed_options(source, needs, whole), {}, costs);
}

Plan plan(const LatLongView& source, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs,
          const Control& control) {
  const platform::FloatingPointScope floating_point;
  return baking::plan_view(source, needs, whole, costs, control);
}

Plan plan(const CubemapView& source, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs,
          const Control& control) {
  const platform::FloatingPointScope floating_point;
  return baking::plan_view(source, needs, whole, costs, control);
}

BakeResult bake(const LatLongView& source, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return baking::bake_planned(source, plan, control);
}

BakeResult bake(const CubemapView& source, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return baking::bake_planned(source, plan, control);
}

namespace {

std::string padded_left(std::string text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string padded_right(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string milliseconds_text(double milliseconds) {
  return platform::number_text(milliseconds, std::chars_format::fixed, milliseconds < 10.0 ? 2 : 0);
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr double kMebibyte = 1024.0 * 1024.0;
  if (bytes == 0) return "-";
  return platform::number_text(static_cast<double>(bytes) / kMebibyte, std::chars_format::fixed, 2);
}

/// Of passes of that name together: the sky's tables have one for every three wavelengths.
const PassRecord* record_of(const std::vector<PassRecord>& measured, const std::string& name, double& milliseconds) {
  const PassRecord* found = nullptr;
  milliseconds = 0.0;
  for (const PassRecord& record : measured) {
    if (record.name != name) continue;
    found = &record;
    milliseconds += record.milliseconds;
  }
  return found;
}

constexpr std::size_t kNumber = 14;

std::string line_of(const PlannedPass& pass, const std::vector<PassRecord>& measured, std::size_t width) {
  const bool skipped = pass.action == PassAction::skip;
  std::string text = "  " + padded_right(pass.name, width + 2) + padded_right(name(pass.action), 6) +
                     padded_left(skipped ? "-" : milliseconds_text(pass.predicted_milliseconds), kNumber);
  std::string reason = pass.reason;
  if (!measured.empty()) {
    double milliseconds = 0.0;
    const PassRecord* const record = record_of(measured, pass.name, milliseconds);
    text += padded_left(record == nullptr || skipped ? "-" : milliseconds_text(milliseconds), kNumber);
    if (record != nullptr && record->action != pass.action) reason = name(record->action) + (": " + record->reason);
  }
  return text + padded_left(bytes_text(pass.bytes), kNumber) + "  " + reason + '\n';
}

}  // namespace

std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured) {
  const platform::FloatingPointScope floating_point;
  std::size_t width = 5;
  for (const PlannedPass& pass : passes) width = std::max(width, pass.name.size());
  std::string text =
      "  " + padded_right("pass", width + 2) + padded_right("", 6) + padded_left("predicted ms", kNumber);
  if (!measured.empty()) text += padded_left("measured ms", kNumber);
  text += padded_left("MiB", kNumber) + "  why\n";
  double predicted = 0.0;
  double took = 0.0;
  for (const PlannedPass& pass : passes) {
    text += line_of(pass, measured, width);
    predicted += pass.predicted_milliseconds;
    double milliseconds = 0.0;
    record_of(measured, pass.name, milliseconds);
    took += milliseconds;
  }
  text += "  " + padded_right("sum", width + 8) + padded_left(milliseconds_text(predicted), kNumber);
  if (!measured.empty()) text += padded_left(milliseconds_text(took), kNumber);
  return text + '\n';
}

std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured) {
  const platform::FloatingPointScope floating_point;
  return "Plan for " + plan.source + '\n' + passes_text(plan.passes, measured) + "  at most " +
         bytes_text(plan.result_bytes) + " MiB of results and " + bytes_text(plan.working_bytes) +
         " MiB of working memory; predicted on one thread\n";
}

namespace {

// An environment that was turned or scaled: what stays, and what is turned and scaled with it.

bool turns(const EnvironmentChange& change) { return change.turn != glm::dmat3(1.0); }
bool scales(const EnvironmentChange& change) { return change.scale != glm::dvec3(1.0); }

void check(const EnvironmentChange& change) {
  for (glm::length_t c = 0; c < 3; ++c) {
    if (change.scale[c] >= 0.0 && std::isfinite(change.scale[c])) continue;
    throw Error(ErrorCode::invalid_argument, "an environment cannot be scaled by " +
                                                 platform::number_text(change.scale[c]) +
                                                 "; pass a finite factor that is not negative");
  }
  // Refuses what is no turn, whether or not there is light to turn.
  if (turns(change)) static_cast<void>(turned(SphericalHarmonics(1), change.turn));
}

std::string how(const EnvironmentChange& change) {
  if (turns(change)) return scales(change) ? "turned and scaled" : "turned";
  return scales(change) ? "scaled" : "as it was";
}

bool evaluates_irradiance(const BakeOptions& baked) {
  return baked.irradiance && baked.bands > 0 && baked.irradiance->method == IrradianceMethod::harmonics;
}

PlannedPass kept(std::string name, bool is_there, const EnvironmentChange& change) {
  if (!is_there) return {std::move(name), PassAction::skip, "there is none", 0.0, 0};
  return {std::move(name), PassAction::reuse, "lookups are " + how(change) + " by the shader", 0.0, 0};
}

}  // namespace

Plan plan_change(const BakeOptions& baked, const EnvironmentChange& change, const CostModel& costs) {
  const platform::FloatingPointScope floating_point;
  check(change);
  constexpr double kNanoseconds = 1e6;  // in a millisecond
  constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);
  Plan plan;
  plan.source = "an environment that was baked before, " + how(change);
  plan.options = baked;
  plan.passes = {{"clean", PassAction::skip, "no pixel is read", 0.0, 0},
                 kept("specular", baked.specular.has_value(), change),
                 kept("background", baked.background.has_value(), change),
                 kept("background mips", baked.background && baked.background->mips, change)};
  if (baked.bands > 0) {
    plan.passes.push_back({"project", PassAction::reuse, "coefficients, " + how(change), 0.0, 0});
  } else {
    plan.passes.push_back({"project", PassAction::skip, "there are no coefficients", 0.0, 0});
  }
  if (evaluates_irradiance(baked)) {
    const double texels = 6.0 * baked.irradiance->size * baked.irradiance->size;
    const double cost = costs.irradiance_term * texels * baked.bands * baked.bands / kNanoseconds;
    plan.result_bytes = kTexelBytes * static_cast<std::uint64_t>(texels);
    plan.passes.push_back(
        {"irradiance", PassAction::run, "from the coefficients, " + how(change), cost, plan.result_bytes});
  } else {
    plan.passes.push_back(kept("irradiance", baked.irradiance.has_value(), change));
  }
  if (baked.brdf) {
    plan.passes.push_back({"brdf", PassAction::reuse, "it depends on no scene", 0.0, 0});
  } else {
    plan.passes.push_back({"brdf", PassAction::skip, "there is none", 0.0, 0});
  }
  return plan;
}

void apply_change(BakeResult& result, const BakeOptions& baked, const EnvironmentChange& change,
                  const Control& control) {
  const platform::FloatingPointScope floating_point;
  check(change);
  result.diagnostics.total_radiance *= change.scale;
  result.diagnostics.total_radiance_before_clamp *= change.scale;
  if (!result.radiance) return;
  SphericalHarmonics radiance = *result.radiance;
  if (turns(change)) radiance = turned(radiance, change.turn);
  if (scales(change)) radiance = scale(radiance, change.scale);
  if (evaluates_irradiance(baked)) {
    result.irradiance = irradiance_cubemap(irradiance_from_radiance(radiance), baked.irradiance->size, control);
  }
  result.radiance = std::move(radiance);
}

}  // namespace welkin
