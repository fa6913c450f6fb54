#include "welkin/plan.h"

#include <algorithm>
#include <utility>

#include "bake/bake_source.h"
#include "plan/planning.h"
#include "plan/spend_budget.h"
#include "welkin/error.h"

namespace welkin {
namespace planning {
namespace {

template <class View>
BakeResult bake_planned(const View& source, const Plan& plan, const Control& control) {
  const std::string words = shape_of(source).words();
  if (words != plan.source) {
    throw Error(ErrorCode::invalid_argument,
                "the plan is for a " + plan.source + ", the source is a " + words + "; plan again for this source");
  }
  BakeResult result;
  baking::bake_source(result, source, plan.options, {}, plan.passes, control);
  return result;
}

template <class View>
Plan plan_view(const View& view, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs,
               const Control& control) {
  check(needs);
  const SourceShape source = shape_of(view);
  NeededOptions needed = needed_options(source, needs, whole);
  if (needs.error_budget) spend_budget(view, *needs.error_budget, needed, control);
  return plan_pixels(source, needed, {}, costs);
}

}  // namespace

Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const baking::StoredKinds& stored,
                 const CostModel& costs) {
  const baking::BakePlan baking = baking::plan_bake(source, needed.options, stored, costs);
  Plan plan;
  plan.source = source.words();
  plan.options = needed.options;
  plan.take_specular = baking.stored_specular;
  plan.take_levels = baking.stored_background;
  plan.take_light = baking.stored_harmonics;
  plan.result_bytes = baking.result_bytes;
  plan.working_bytes = baking.working_bytes;
  for (const baking::BakeStep& step : baking.steps) {
    PlannedPass& pass = plan.passes.emplace_back(step.planned);
    for (const LeftOut& left_out : needed.left_out) {
      if (left_out.pass == step.pass && pass.action == PassAction::skip) pass.reason = left_out.reason;
    }
    for (const ChosenSetting& chosen : needed.chosen) {
      if (chosen.pass == step.pass && pass.action != PassAction::skip) pass.reason += "; " + chosen.words;
    }
  }
  return plan;
}

}  // namespace planning

double Plan::milliseconds(int threads) const noexcept {
  double sum = 0.0;
  for (const PlannedPass& pass : passes) sum += pass.predicted_milliseconds;
  return sum / std::max(1, threads);
}

const PlannedPass& Plan::pass(const std::string& name) const {
  const auto found = std::ranges::find(passes, name, &PlannedPass::name);
  if (found == passes.end()) throw Error(ErrorCode::invalid_argument, "the plan has no pass called " + name);
  return *found;
}

Plan plan(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs) {
  check(needs);
  planning::refuse_budget(needs, "plan the view of the pixels instead of their shape");
  return planning::plan_pixels(source, planning::needed_options(source, needs, whole), {}, costs);
}

Plan plan(const LatLongView& source, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs,
          const Control& control) {
  return planning::plan_view(source, needs, whole, costs, control);
}

Plan plan(const CubemapView& source, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs,
          const Control& control) {
  return planning::plan_view(source, needs, whole, costs, control);
}

BakeResult bake(const LatLongView& source, const Plan& plan, const Control& control) {
  return planning::bake_planned(source, plan, control);
}

BakeResult bake(const CubemapView& source, const Plan& plan, const Control& control) {
  return planning::bake_planned(source, plan, control);
}

}  // namespace welkin
