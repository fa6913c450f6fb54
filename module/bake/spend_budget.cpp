#include "bake/spend_budget.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "jobs/tiles.h"
#include "reflections/prefilter_plan.h"
#include "welkin/error_budget.h"

namespace welkin::baking {
namespace {

constexpr double kBandsShare = 0.3;  ///< of the progress

std::string percent(double share) {
  // Of what cancels to nothing, rounding is any number of times the rest.
  if (!(share < 1.0)) return "100 % or more";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100.0 * share);
  return text;
}

std::string bands_text(int bands) { return std::to_string(bands) + (bands == 1 ? " band" : " bands"); }

/// The fewest that do, among those that are there: shaders read no more.
void pick_bands(const BudgetChoice<int>& choice, double budget, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  const EstimatedSetting<int>* last = nullptr;
  const EstimatedSetting<int>* fewest = nullptr;
  for (const EstimatedSetting<int>& entry : choice.tried) {
    const bool meets = entry.estimated_error <= budget;
    if (meets && fewest == nullptr) fewest = &entry;
    if (entry.setting <= options.bands) last = &entry;
  }
  std::string words;
  if (fewest != nullptr && fewest->setting <= options.bands) {
    options.bands = fewest->setting;
    words = bands_text(options.bands) + " picked: estimated error of irradiance " + percent(fewest->estimated_error) +
            ", budget " + percent(budget);
  } else {
    words = "no fewer: estimated error of irradiance " + percent(last->estimated_error) + ", above the budget of " +
            percent(budget);
    if (fewest != nullptr) words += ", which " + bands_text(fewest->setting) + " would meet";
  }
  needed.chosen.push_back({BakePass::project, std::move(words)});
}

std::string unmet_words(const PrefilterChoice& choice, double budget) {
  const std::string words = "bounds as they were: ";
  const std::vector<reflections::MipPlan> mips = reflections::plan_prefilter(choice.setting).mips;
  if (std::ranges::any_of(mips, [](const auto& mip) { return !mip.copy && mip.bands.bands() == 0; }))
    return words + "a mip that is sampled has no estimate for the budget";
  return words + "of none is the estimated error under the budget of " + percent(budget) + ", the least is " +
         percent(choice.estimated_error);
}

void pick_bounds(const PrefilterChoice& choice, double budget, NeededOptions& needed) {
  std::string words;
  if (choice.met) {
    PrefilterOptions& specular = *needed.options.specular;
    specular.rms_error = choice.setting.rms_error;
    specular.maximum_error = choice.setting.maximum_error;
    words = "rms bound " + percent(specular.rms_error) + " picked: estimated error of the worst mip " +
            percent(choice.estimated_error) + ", budget " + percent(budget);
  } else {
    words = unmet_words(choice, budget);
  }
  needed.chosen.push_back({BakePass::specular, std::move(words)});
}

template <class View>
void spend(const View& view, double relative, NeededOptions& needed, const Control& control) {
  const ErrorBudget budget{.relative = relative, .measure = ErrorMeasure::rms};
  const BakeOptions& options = needed.options;
  if (options.bands > 0) {
    const Control part = jobs::part_of(control, 0.0, kBandsShare);
    pick_bands(choose_irradiance_bands(view, budget, options.pixels, part), relative, needed);
  }
  if (options.specular && options.specular->method == PrefilterMethod::automatic) {
    PrefilterOptions asked = *options.specular;
    asked.pixels = options.pixels;
    const Control part = jobs::part_of(control, kBandsShare, 1.0);
    pick_bounds(choose_prefilter(view, asked, budget, false, part), relative, needed);
  } else if (options.specular) {
    needed.chosen.push_back({BakePass::specular, "the method that was asked for has no estimate for a budget"});
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
