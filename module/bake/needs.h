// A bake of everything, less what a scene does not need.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bake/bake_plan.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::baking {

struct NeededOptions {
  BakeOptions options;
  std::map<BakePass, std::string> left_out{};  ///< why a pass of the whole bake falls away
  std::string unused_mips{};                   ///< for the chain's reason: "; left out: 1 sharper, 0 rougher", or empty
};

/// Consecutive mips of a chain.
struct UsedMips {
  int first;
  int count;
};

[[nodiscard]] NeededOptions needed_options(const SourceShape& source, const SceneNeeds& needs,
                                           const BakeOptions& full_options);

/// Returns the mips that lookups from `range.minimum` to `range.maximum` read: all, unless the roughness of mips rises.
[[nodiscard]] UsedMips used_mips(const std::vector<double>& roughness, const RoughnessRange& range);

/// Reduces a chain to the mips that are used, and returns a text for `NeededOptions::unused_mips`.
[[nodiscard]] std::string keep_used_mips(const RoughnessRange& range, PrefilterOptions& options);

// Plans put together: what photographs and files have in common.

/// `stored`: what the source brings along and may be taken.
[[nodiscard]] Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const StoredKinds& stored);

/// Formats a table of passes, as `plan_text` does.
[[nodiscard]] std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured);

}  // namespace welkin::baking
