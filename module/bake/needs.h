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
};

[[nodiscard]] NeededOptions needed_options(const SourceShape& source, const SceneNeeds& needs,
                                           const BakeOptions& whole);

/// Mips, of a table of roughness that rises, that no lookup from `range.minimum` to `range.maximum` touches.
[[nodiscard]] UnusedMips unused_mips(const std::vector<double>& roughness, const RoughnessRange& range);

/// The options of a chain of its own that has all mips but those. Throws `Error` (invalid_argument) unless one is left.
[[nodiscard]] PrefilterOptions chain_without(const UnusedMips& unused, const PrefilterOptions& options);

// Plans put together: what photographs and files have in common.

/// `stored`: what the source brings along and may be taken.
[[nodiscard]] Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const StoredKinds& stored);

}  // namespace welkin::baking
