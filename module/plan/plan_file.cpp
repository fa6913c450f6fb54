// Plans for files: what they carry already, and whether their pixels are wanted at all.
#include <algorithm>

#include "plan/planning.h"

namespace welkin {
namespace planning {
namespace {

constexpr const char* kRead = "read";

/// Stored results were made of the pixels as they are, and as the file says.
bool changes_pixels(const StoredEnvironment& file, const BakeOptions& options) {
  return file.read.transfer != Transfer::automatic || options.pixels.clamp || options.pixels.gamma ||
         options.pixels.negative != NegativePolicy::keep || options.pixels.nan == NonFinitePolicy::reject ||
         options.pixels.infinity == NonFinitePolicy::reject;
}

UnusedMips unused_of(const StoredEnvironment& file, const SceneNeeds& needs) {
  return unused_mips(file.roughness, *needs.glossy);
}

bool takes_specular(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& options) {
  if (!options.specular || !needs.glossy || file.content != LevelContent::reflections) return false;
  return std::ranges::is_sorted(file.roughness) && file.roughness.front() <= needs.glossy->least &&
         file.roughness.back() >= needs.glossy->greatest;
}

baking::StoredKinds stored_kinds(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& options) {
  baking::StoredKinds kinds;
  if (!needs.stored_results || changes_pixels(file, options)) return kinds;
  if (file.has_polynomial) kinds.harmonics_bands = 3;
  if (file.content == LevelContent::radiance) kinds.background_levels = file.levels;
  if (!takes_specular(file, needs, options)) return kinds;
  const UnusedMips unused = unused_of(file, needs);
  kinds.specular_mips = file.levels - unused.sharp - unused.rough;
  kinds.specular_size = std::max(1, file.shape.columns >> unused.sharp);
  return kinds;
}

bool wants_pixels(const Plan& plan) {
  if (plan.take_specular) return true;  // of the chain itself
  return plan.pass("clean").action != PassAction::skip || plan.pass("project").action == PassAction::run;
}

/// Nothing but a projection, or less. (What reads a file for its light alone takes a stored polynomial, asked or not.)
bool streams(const StoredEnvironment& file, const Plan& plan) {
  if (plan.pass("clean").action != PassAction::skip || plan.take_specular) return false;
  return plan.take_light || !file.has_polynomial || plan.pass("project").action == PassAction::skip;
}

PlannedPass read_pass(const StoredEnvironment& file, const Plan& plan, const CostModel& costs) {
  constexpr double kNanoseconds = 1e6;  // in a millisecond
  if (!wants_pixels(plan))
    return {kRead, PassAction::skip, "no pass wants pixels; the header has all that is needed", 0.0, 0};
  auto texels = static_cast<double>(file.shape.texels());
  if (plan.take_specular || plan.take_levels) texels *= 4.0 / 3.0;
  const double cost = texels * (file.compressed ? costs.read_texel : costs.read_plain_texel) / kNanoseconds;
  if (plan.streams) return {kRead, PassAction::run, "projected while it is read", cost, 0};
  const std::uint64_t bytes = static_cast<std::uint64_t>(texels) * 3 * sizeof(float);
  return {kRead, PassAction::run, file.words(), cost, bytes};
}

}  // namespace
}  // namespace planning

Plan plan(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs) {
  check(needs);
  planning::refuse_budget(needs, "read the file and plan the view of its pixels");
  planning::NeededOptions needed = planning::needed_options(file.shape, needs, whole);
  const baking::StoredKinds kinds = planning::stored_kinds(file, needs, needed.options);
  Plan plan = planning::plan_pixels(file.shape, needed, kinds, costs);
  plan.source = file.words();
  if (plan.take_specular) {
    plan.first_stored_mip = planning::unused_of(file, needs).sharp;
    plan.stored_mips = kinds.specular_mips;
  }
  plan.streams = planning::streams(file, plan);
  plan.passes.insert(plan.passes.begin(), planning::read_pass(file, plan, costs));
  return plan;
}

}  // namespace welkin
