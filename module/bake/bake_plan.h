// The plan of a bake: what it will do and what memory it needs, settled before any of it runs.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "reflections/prefilter_plan.h"
#include "welkin/bake.h"

namespace welkin::baking {

/// The passes, in the order in which they are planned and recorded. The last exists only if it was requested.
enum class BakePass { sanitize, specular, background, background_mips, project, irradiance, brdf, octahedral };

/// "sanitize", "specular", "background", "background mips", "project", "irradiance", "brdf", "octahedral"
[[nodiscard]] const char* name(BakePass pass) noexcept;

struct BakeStep {
  BakePass pass;
  PlannedPass planned;
  double weight;                ///< approximate nanoseconds on one thread: for the order of passes and the progress
  std::vector<BakePass> after;  ///< passes that must have ended; skipped ones count as ended
};

/// The kinds and sizes of the results that came with the pixels, without their values.
struct StoredKinds {
  int harmonics_bands = 0;    ///< 0: none
  int specular_mips = 0;      ///< of a prefiltered chain; 0: none
  int specular_size = 0;      ///< texels along an edge of its mip 0
  int background_levels = 0;  ///< plain mips, the source itself the first; 0: none
};

struct BakePlan {
  int background_size = 0;    ///< 0: none
  int background_levels = 0;  ///< 0: none
  /// The mips that are computed; none if the chain is stored or not requested.
  std::optional<reflections::PrefilterPlan> prefilter;
  bool same_level = false;  ///< specular mip 0 is the background's level 0
  bool stored_harmonics = false;
  IrradianceMethod irradiance = IrradianceMethod::automatic;  ///< `harmonics` also where stored ones are used
  /// The plan by which the automatic method makes irradiance: its own, or that of the chain whose harmonics it shares.
  std::optional<reflections::PrefilterPlan> irradiance_plan;
  bool shares_harmonics = false;  ///< if true, `prefilter` has irradiance too
  bool stored_specular = false;
  std::optional<OctahedralOptions> octahedral;  ///< has no more levels than there are mips
  bool stored_background = false;
  ProjectionOptions projecting{};

  std::uint64_t result_bytes = 0;
  std::uint64_t working_bytes = 0;  ///< upper bound for all passes that may run at once
  std::vector<BakeStep> steps;      ///< each pass once: run, planned and recorded

  [[nodiscard]] const BakeStep& step(BakePass pass) const { return steps[static_cast<std::size_t>(pass)]; }
  [[nodiscard]] bool runs(BakePass pass) const { return step(pass).planned.action != PassAction::skip; }
  /// Returns whether an irradiance cubemap is made of the pixels themselves.
  [[nodiscard]] bool convolves() const {
    return runs(BakePass::irradiance) && irradiance != IrradianceMethod::harmonics;
  }
};

/// Plans a bake. Throws `Error` (invalid_argument) for options that are out of range or do not go together.
[[nodiscard]] BakePlan plan_bake(const SourceShape& source, const BakeOptions& options, const StoredKinds& stored = {});

/// Returns the background's size; 0 if there is none.
[[nodiscard]] int background_size(const SourceShape& source, const BakeOptions& options);

/// Returns the pass "specular" of a bake that computes these mips.
[[nodiscard]] PlannedPass plan_prefilter_pass(const SourceShape& source, const reflections::PrefilterPlan& plan);

/// Returns the texels of a chain of cubemaps.
[[nodiscard]] std::uint64_t chain_texels(int size, int levels) noexcept;

/// Throws `Error` (limit_exceeded) if the plan needs more than the options allow.
void require_memory(const BakePlan& plan, const BakeOptions& options);

// A bake of everything, minus the passes that a scene does not need.

struct NeededOptions {
  BakeOptions options;
  std::map<BakePass, std::string> left_out{};  ///< why a pass of the whole bake is left out
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

// Making plans, for photographs and files alike.

/// `stored`: the usable results that the source brings along.
[[nodiscard]] Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const StoredKinds& stored);

/// Returns the pass of that name. Throws `Error` (invalid_argument) if there is none.
[[nodiscard]] const PlannedPass& pass_of(const std::vector<PlannedPass>& passes, const std::string& name);

/// Formats a table of passes, as `plan_text` does.
[[nodiscard]] std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured);

}  // namespace welkin::baking
