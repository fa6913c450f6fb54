#include "bake/needs.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include "budget/budget.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "reflections/prefilter_plan.h"
#include "welkin/core.h"
#include "welkin/error_budget.h"
#include "welkin/plan.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

void check(const SceneNeeds& needs) {
  const platform::FloatingPointScope floating_point;
  image::require_range("diffuse_bands", needs.diffuse_bands, 0, kMaximumBands);
  if (needs.error_budget) budget::check_budget({.relative = *needs.error_budget});
  if (!needs.glossy) return;
  const RoughnessRange& range = *needs.glossy;
  if (range.minimum >= 0.0 && range.minimum <= range.maximum && range.maximum <= 1.0) return;
  throw Error(ErrorCode::invalid_argument, "glossy materials' roughness is from " +
                                               platform::number_text(range.minimum) + " to " +
                                               platform::number_text(range.maximum) + "; it must rise, from 0 to 1");
}

}  // namespace welkin

namespace welkin::baking {
namespace {

constexpr const char* kNotGlossy = "no glossy materials";

void need_diffuse(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (needs.diffuse_bands == 0 && options.bands > 0) {
    needed.trim.projected_bands = 0;
    needed.left_out[BakePass::project] = "no diffuse light is used";
  } else if (needs.same_bits && needs.diffuse_bands < options.bands) {
    needed.trim.projected_bands = options.bands;
  }
  options.bands = std::min(options.bands, needs.diffuse_bands);
  if (!options.irradiance || (needs.irradiance_cubemap && needs.diffuse_bands > 1)) return;
  options.irradiance.reset();
  needed.left_out[BakePass::irradiance] = needs.diffuse_bands == 0   ? "no diffuse light is used"
                                          : needs.diffuse_bands == 1 ? "ambient only: one colour is all of it"
                                                                     : "diffuse light is read from coefficients";
}

void need_reflections(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (!needs.glossy) {
    if (options.specular) needed.left_out[BakePass::specular] = kNotGlossy;
    if (options.brdf) needed.left_out[BakePass::brdf] = kNotGlossy;
    options.specular.reset();
    options.octahedral.reset();
    options.brdf.reset();
    return;
  }
  if (options.specular) {
    const UnusedMips unused = unused_mips(reflections::roughness_of_chain(*options.specular), *needs.glossy);
    if (needs.same_bits) {
      needed.trim.mips = unused;
    } else {
      options.specular = chain_without(unused, *options.specular);
      if (options.octahedral)
        options.octahedral->levels = std::min(options.octahedral->levels, *options.specular->mips);
    }
  }
  if (!needs.brdf_table && options.brdf) {
    needed.left_out[BakePass::brdf] = "the engine has a table of its own";
    options.brdf.reset();
  }
}

/// Comes first: the background's size must not follow the specular cubemap's when that is made smaller or not at all.
void need_background(const SourceShape& source, const SceneNeeds& needs, NeededOptions& needed) {
  std::optional<BackgroundOptions>& background = needed.options.background;
  if (!background) return;
  if (!needs.background) {
    background.reset();
    needed.left_out[BakePass::background] = "nothing shows it";
    return;
  }
  background->size = background_size(source, needed.options);
  if (needs.background_mips || !background->mips) return;
  background->mips = false;
  needed.left_out[BakePass::background_mips] = "it is shown at full size alone";
}

}  // namespace

UnusedMips unused_mips(const std::vector<double>& roughness, const RoughnessRange& range) {
  if (!platform::ranges::is_sorted(roughness)) return {};  // who knows where shaders look
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

PrefilterOptions chain_without(const UnusedMips& unused, const PrefilterOptions& options) {
  const std::vector<double> whole = reflections::roughness_of_chain(options);
  const auto mips = static_cast<int>(whole.size());
  image::require_range("the number of sharp mips that are left out", unused.sharp, 0, mips - 1);
  image::require_range("the number of rough mips that are left out", unused.rough, 0, mips - 1 - unused.sharp);
  PrefilterOptions rest = options;
  rest.size = std::max(1, options.size >> unused.sharp);
  rest.roughness.assign(whole.begin() + unused.sharp, whole.end() - unused.rough);
  rest.mips = static_cast<int>(rest.roughness.size());
  const auto lobes = static_cast<int>(rest.lobe_roughness.size());
  if (lobes > 0)
    rest.lobe_roughness.erase(rest.lobe_roughness.begin(), rest.lobe_roughness.begin() + std::min(unused.sharp, lobes));
  const auto spectra = static_cast<int>(rest.spectra.size());
  if (spectra > 0) rest.spectra.erase(rest.spectra.begin(), rest.spectra.begin() + std::min(unused.sharp, spectra));
  return rest;
}

NeededOptions needed_options(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& whole) {
  NeededOptions needed{whole};
  SceneNeeds settled = needs;
  if (needs.error_budget) settled.same_bits = false;
  need_background(source, settled, needed);
  need_diffuse(settled, needed);
  need_reflections(settled, needed);
  return needed;
}

void refuse_budget(const SceneNeeds& needs, const std::string& instead) {
  if (!needs.error_budget) return;
  throw Error(ErrorCode::invalid_argument, "an error_budget needs pixels, and here are none; " + instead);
}

namespace {

constexpr double kBandsShare = 0.3;  ///< of the progress

std::string percent(double share) {
  // Of what cancels to nothing, rounding is any number of times the rest.
  if (!(share < 1.0)) return "100 % or more";
  return platform::number_text(100.0 * share, std::chars_format::general, 3) + " %";
}

std::string bands_text(int bands) { return std::to_string(bands) + (bands == 1 ? " band" : " bands"); }

/// The fewest that do, among those that are there: shaders read no more.
void pick_bands(const BudgetChoice<int>& choice, double budget, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  const EstimatedSetting<int>* last = nullptr;
  const EstimatedSetting<int>* fewest = nullptr;
  for (const EstimatedSetting<int>& entry : choice.tried) {
    const bool meets = entry.error_estimate <= budget;
    if (meets && fewest == nullptr) fewest = &entry;
    if (entry.setting <= options.bands) last = &entry;
  }
  std::string words;
  if (fewest != nullptr && fewest->setting <= options.bands) {
    options.bands = fewest->setting;
    words = bands_text(options.bands) + " picked: estimated error of irradiance " + percent(fewest->error_estimate) +
            ", budget " + percent(budget);
  } else {
    words = "no fewer: estimated error of irradiance " + percent(last->error_estimate) + ", above the budget of " +
            percent(budget);
    if (fewest != nullptr) words += ", which " + bands_text(fewest->setting) + " would meet";
  }
  needed.chosen[BakePass::project] = std::move(words);
}

void pick_bounds(const PrefilterChoice& choice, double budget, NeededOptions& needed) {
  std::string words;
  if (choice.met) {
    PrefilterOptions& specular = *needed.options.specular;
    specular.rms_error = choice.setting.rms_error;
    specular.maximum_error = choice.setting.maximum_error;
    words = "rms bound " + percent(specular.rms_error) + " picked: estimated error of the worst mip " +
            percent(choice.error_estimate) + ", budget " + percent(budget);
  } else {
    words = "bounds as they were: of none is the estimated error under the budget of " + percent(budget) +
            ", the minimum is " + percent(choice.error_estimate);
  }
  needed.chosen[BakePass::specular] = std::move(words);
}

template <class View>
void spend(const View& view, double relative, NeededOptions& needed, const Control& control) {
  const ErrorBudget budget{.relative = relative, .measure = ErrorMeasure::rms};
  const BakeOptions& options = needed.options;
  if (options.bands > 0) {
    const Control part = jobs::part_of(control, 0.0, kBandsShare);
    pick_bands(choose_irradiance_bands(view, budget, options.pixels, part), relative, needed);
  }
  if (needed.options.irradiance)
    needed.options.irradiance->rms_error = std::min(needed.options.irradiance->rms_error, relative);
  const bool estimated = options.specular && options.specular->method == PrefilterMethod::automatic &&
                         options.specular->lobe == LobeFamily::ggx;
  if (estimated) {
    PrefilterOptions asked = *options.specular;
    asked.pixels = options.pixels;
    const Control part = jobs::part_of(control, kBandsShare, 1.0);
    pick_bounds(choose_prefilter(view, asked, budget, false, part), relative, needed);
  } else if (options.specular) {
    needed.chosen[BakePass::specular] = options.specular->lobe == LobeFamily::ggx
                                            ? "the method that was asked for has no estimate for a budget"
                                            : "a budget has no estimate for this lobe";
  }
}

}  // namespace

void spend_budget(const LatLongView& view, double budget, NeededOptions& needed, const Control& control) {
  spend(view, budget, needed, control);
}

void spend_budget(const CubemapView& view, double budget, NeededOptions& needed, const Control& control) {
  spend(view, budget, needed, control);
}

}  // namespace welkin::baking
