#include "bake/needs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "budget/projection_budget.h"
#include "image/pixels.h"
#include "reflections/prefilter_plan.h"
#include "welkin/error.h"
#include "welkin/scene_needs.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

void check(const SceneNeeds& needs) {
  image::require_range("diffuse_bands", needs.diffuse_bands, 0, kMaximumBands);
  if (needs.error_budget) budget::check_budget({.relative = *needs.error_budget});
  if (!needs.glossy) return;
  const RoughnessRange& range = *needs.glossy;
  if (range.minimum >= 0.0 && range.minimum <= range.maximum && range.maximum <= 1.0) return;
  throw Error(ErrorCode::invalid_argument, "glossy materials' roughness is from " + std::to_string(range.minimum) +
                                               " to " + std::to_string(range.maximum) + "; it must rise, from 0 to 1");
}

}  // namespace welkin

namespace welkin::baking {
namespace {

using baking::BakePass;

constexpr const char* kNotGlossy = "no glossy materials";

/// The background's size must not follow the specular cubemap's when that is made smaller or not at all.
int background_size(const SourceShape& source, const BakeOptions& whole) {
  if (!whole.background) return 0;
  BakeOptions shown = whole;  // what the rest demands of each other is no matter here
  shown.irradiance_size = 0;
  return plan_bake(source, shown).background_size;
}

void need_diffuse(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  const bool had_irradiance = options.irradiance_size > 0;
  const bool had_bands = options.bands > 0;
  if (needs.same_bits && needs.diffuse_bands < options.bands)
    options.projected_bands = std::max(options.projected_bands, options.bands);
  options.bands = std::min(options.bands, needs.diffuse_bands);
  if (needs.diffuse_bands == 0 && had_bands) {
    options.total_radiance = false;
    needed.left_out.push_back({BakePass::project, "no diffuse light is used"});
  }
  if (!had_irradiance || (needs.irradiance_cubemap && needs.diffuse_bands > 1)) return;
  options.irradiance_size = 0;
  needed.left_out.push_back({BakePass::irradiance, needs.diffuse_bands == 0 ? "no diffuse light is used"
                                                   : needs.diffuse_bands == 1
                                                       ? "ambient only: one colour is all of it"
                                                       : "diffuse light is read from coefficients"});
}

void need_reflections(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (!needs.glossy) {
    if (options.specular) needed.left_out.push_back({BakePass::specular, kNotGlossy});
    if (options.brdf) needed.left_out.push_back({BakePass::brdf, kNotGlossy});
    options.specular.reset();
    options.brdf.reset();
    return;
  }
  if (options.specular) {
    const std::vector<double> roughness = reflections::roughness_of_chain(*options.specular);
    leave_out(unused_mips(roughness, *needs.glossy), needs.same_bits, *options.specular);
  }
  if (!needs.brdf_table && options.brdf) {
    needed.left_out.push_back({BakePass::brdf, "the engine has a table of its own"});
    options.brdf.reset();
  }
}

void need_background(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& whole,
                     NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (!options.background) return;
  if (!needs.background) {
    options.background = false;
    needed.left_out.push_back({BakePass::background, "nothing shows it"});
    return;
  }
  options.background_size = background_size(source, whole);
  if (needs.background_mips || !options.background_mips) return;
  options.background_mips = false;
  needed.left_out.push_back({BakePass::background_mips, "it is shown at full size alone"});
}

}  // namespace

UnusedMips unused_mips(const std::vector<double>& roughness, const RoughnessRange& range) {
  if (!std::ranges::is_sorted(roughness)) return {};  // who knows where shaders look
  const auto mips = static_cast<int>(roughness.size());
  const auto at = [&](int mip) { return roughness[static_cast<std::size_t>(mip)]; };
  int first = 0;
  while (first + 1 < mips && at(first + 1) <= range.minimum) ++first;
  while (first > 0 && at(first - 1) == at(first)) --first;  // a lookup may find either
  int last = mips - 1;
  while (last > first && at(last - 1) >= range.maximum) --last;
  while (last + 1 < mips && at(last + 1) == at(last)) ++last;
  return {first, mips - 1 - last};
}

void leave_out(const UnusedMips& unused, bool same_bits, PrefilterOptions& options) {
  const std::vector<double> whole = reflections::roughness_of_chain(options);
  if (same_bits) {
    options.mips = static_cast<int>(whole.size());
    options.roughness = whole;
    options.leave_out_sharp = std::max(options.leave_out_sharp, unused.sharp);
    options.leave_out_rough = std::max(options.leave_out_rough, unused.rough);
    return;
  }
  options.size = std::max(1, options.size >> unused.sharp);
  options.roughness.assign(whole.begin() + unused.sharp, whole.end() - unused.rough);
  options.mips = static_cast<int>(options.roughness.size());
  // What the caller left out already is in what is cut off, or beyond it.
  options.leave_out_sharp = std::max(0, options.leave_out_sharp - unused.sharp);
  options.leave_out_rough = std::max(0, options.leave_out_rough - unused.rough);
}

NeededOptions needed_options(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& whole) {
  NeededOptions needed{whole, {}};
  SceneNeeds settled = needs;
  if (needs.error_budget) settled.same_bits = false;
  need_background(source, settled, whole, needed);
  need_diffuse(settled, needed);
  need_reflections(settled, needed);
  return needed;
}

void refuse_budget(const SceneNeeds& needs, const std::string& instead) {
  if (!needs.error_budget) return;
  throw Error(ErrorCode::invalid_argument, "an error_budget is judged by pixels, and there are none here; " + instead);
}

}  // namespace welkin::baking
