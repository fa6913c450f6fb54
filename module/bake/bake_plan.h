// What a bake will do, what it needs and what it is expected to cost: settled before any of it runs.
#pragma once

#include <cstdint>
#include <vector>

#include "welkin/bake.h"
#include "welkin/plan.h"

namespace welkin::baking {

/// The passes, in the order in which they are planned and recorded.
enum class BakePass { sanitize, specular, background, background_mips, project, irradiance, brdf };

/// "clean", "specular", "background", "background mips", "project", "irradiance", "brdf"
[[nodiscard]] const char* name(BakePass pass) noexcept;

struct BakeStep {
  BakePass pass;
  PlannedPass planned;
  std::vector<BakePass> after;  ///< that must have ended; of those that are skipped nothing is waited for
};

/// What came with the pixels: of what kind, not what it is.
struct StoredKinds {
  int harmonics_bands = 0;    ///< 0: none
  int specular_mips = 0;      ///< of a prefiltered chain; 0: none
  int specular_size = 0;      ///< texels along an edge of its mip 0
  int background_levels = 0;  ///< plain mips, the source itself the first; 0: none
};

struct BakePlan {
  int background_size = 0;    ///< 0: none
  int background_levels = 0;  ///< 0: none
  int specular_size = 0;      ///< of what is made; 0: none
  int specular_mips = 0;
  bool same_level = false;  ///< specular mip 0 is the background's level 0
  bool stored_harmonics = false;
  bool stored_specular = false;
  bool stored_background = false;
  ProjectionOptions projecting{};

  std::uint64_t result_bytes = 0;
  std::uint64_t working_bytes = 0;  ///< at most
  std::vector<BakeStep> steps;      ///< each pass once: what is run, planned, predicted and recorded

  [[nodiscard]] BakeStep& step(BakePass pass) { return steps[static_cast<std::size_t>(pass)]; }
  [[nodiscard]] const BakeStep& step(BakePass pass) const { return steps[static_cast<std::size_t>(pass)]; }
};

/// All passes of a plan whose sizes are settled.
[[nodiscard]] std::vector<BakeStep> steps_of(const SourceShape& source, const BakeOptions& options,
                                             const BakePlan& plan);

/// Texels of a chain of cubemaps.
[[nodiscard]] std::uint64_t chain_texels(int size, int levels) noexcept;

/// Fills in what the passes take: working memory of all that may run at the same time, at most, and processor time;
/// `plan.steps` and sizes must be there.
void predict(const SourceShape& source, const BakeOptions& options, const CostModel& costs, BakePlan& plan);

/// Throws `Error` (invalid_argument) for options that are out of range or do not go together.
[[nodiscard]] BakePlan plan_bake(const SourceShape& source, const BakeOptions& options, const StoredKinds& stored = {},
                                 const CostModel& costs = {});

/// Throws `Error` (limit_exceeded) if the plan needs more than the options allow.
void require_memory(std::uint64_t result_bytes, std::uint64_t working_bytes, const BakeOptions& options);

}  // namespace welkin::baking
