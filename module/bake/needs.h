// A bake of everything, less what a scene does not need.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bake/bake_plan.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/plan.h"

namespace welkin::baking {

struct NeededOptions {
  BakeOptions options;
  PlanTrim trim{};
  std::map<BakePass, std::string> left_out{};  ///< why a pass of the whole bake falls away
  std::map<BakePass, std::string> chosen{};    ///< what an error budget did to a pass
};

/// Settings that an error budget may loosen are still those of the whole bake, without what would keep its bits.
[[nodiscard]] NeededOptions needed_options(const SourceShape& source, const SceneNeeds& needs,
                                           const BakeOptions& whole);

/// Throws `Error` (invalid_argument) if there is an error budget: nothing is there that it could be judged by.
/// `instead` says what to do.
void refuse_budget(const SceneNeeds& needs, const std::string& instead);

/// Mips, of a table of roughness that rises, that no lookup from `range.minimum` to `range.maximum` touches.
[[nodiscard]] UnusedMips unused_mips(const std::vector<double>& roughness, const RoughnessRange& range);

/// The options of a chain of its own that has all mips but those. Throws `Error` (invalid_argument) unless one is left.
[[nodiscard]] PrefilterOptions chain_without(const UnusedMips& unused, const PrefilterOptions& options);

// What a scene may lose, spent: the cheapest setting of each pass that this environment allows.

/// Bands of diffuse light up to those that are there, and the prefilter's bounds: picked, and said in `needed.chosen`.
/// `budget`: relative rms. Throws `Error` as `choose_prefilter` and `choose_irradiance_bands`.
void spend_budget(const LatLongView& view, double budget, NeededOptions& needed, const Control& control);
void spend_budget(const CubemapView& view, double budget, NeededOptions& needed, const Control& control);

// Plans put together: what photographs and files have in common.

/// `stored`: what the source brings along and may be taken.
[[nodiscard]] Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const StoredKinds& stored,
                               const CostModel& costs);

}  // namespace welkin::baking
