// What a bake will do for a scene, before any of it is done: which passes run, which are there already, which nobody
// needs, why, and what each is expected to cost.
//
//   const welkin::Plan plan = welkin::plan(panorama, {.glossy = std::nullopt});
//   log(welkin::plan_text(plan));
//   const welkin::BakeResult light = welkin::bake(panorama, plan);
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "welkin/bake.h"
#include "welkin/cost_model.h"
#include "welkin/export.h"
#include "welkin/planned_pass.h"
#include "welkin/scene_needs.h"
#include "welkin/source_shape.h"

namespace WELKIN_EXPORT welkin {

/// What a bake would do, before it does it.
struct Plan {
  std::string source;               ///< "lat-long 1024 x 512"; of files with their name
  std::vector<PlannedPass> passes;  ///< in the order of the records that come out; of files "read" first

  BakeOptions options;         ///< that do it: what the scene does not need is left out of them
  bool take_specular = false;  ///< the file's chain is the result's
  bool take_levels = false;    ///< the file's levels are the background's mips
  int first_stored_mip = 0;    ///< of that chain: the first that is used,
  int stored_mips = 0;         ///< and how many are
  bool take_light = false;     ///< the file's polynomial is the diffuse light
  bool streams = false;  ///< nothing but its light is wanted: it is projected while it is read, or not read at all

  std::uint64_t result_bytes = 0;   ///< memory of the results
  std::uint64_t working_bytes = 0;  ///< at most, beside results and source

  /// Of all passes on one thread: the sum. They share `threads` of them evenly but for the last tiles.
  [[nodiscard]] double milliseconds(int threads = 1) const noexcept;

  /// Throws `Error` (invalid_argument) if no pass has the name.
  [[nodiscard]] const PlannedPass& pass(const std::string& name) const;
};

/// Plans. `whole`: the bake of everything, with its sizes and bounds; what the needs do not use is taken from it. What
/// is left comes out with the bits of that bake (if `needs.same_bits`, and there is no error budget; an irradiance
/// cubemap from harmonics with those of a bake of as many bands as are needed). Throws `Error`
/// (invalid_argument, limit_exceeded) as `bake` and `check`. A shape has no pixels that an error budget could be judged
/// by: with `needs.error_budget` it throws invalid_argument.
[[nodiscard]] Plan plan(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& whole = {},
                        const CostModel& costs = {});
/// With `needs.error_budget` the pixels are looked at, which `control` can follow and stop, and may take longer than
/// what is saved (docs/plans.md): worth it for settings that serve many bakes. Bands of diffuse light are picked up to
/// those that are needed, the prefilter's bounds if its method is automatic; the projection, the background and the
/// table stay exact. Reasons say what was picked, or that nothing met the budget. Throws as `choose_prefilter`,
/// `choose_irradiance_bands` too.
[[nodiscard]] Plan plan(const LatLongView& source, const SceneNeeds& needs, const BakeOptions& whole = {},
                        const CostModel& costs = {}, const Control& control = {});
[[nodiscard]] Plan plan(const CubemapView& source, const SceneNeeds& needs, const BakeOptions& whole = {},
                        const CostModel& costs = {}, const Control& control = {});

/// Carries a plan out; the source must have the shape that was planned for. The records' reasons are the plan's. Throws
/// as `bake`, and invalid_argument for another source.
[[nodiscard]] BakeResult bake(const LatLongView& source, const Plan& plan, const Control& control = {});
[[nodiscard]] BakeResult bake(const CubemapView& source, const Plan& plan, const Control& control = {});

/// How an environment changed that was baked before: what came from direction d comes from turn * d, times a factor.
struct EnvironmentChange {
  glm::dmat3 turn{1.0};   ///< orthogonal
  glm::dvec3 scale{1.0};  ///< of red, green and blue: exposure; not negative
};

/// What such a change costs a result that was baked with `baked`: coefficients are turned and scaled, an irradiance
/// cubemap from harmonics is evaluated anew, and cubemaps stay: lookups are turned back (transpose(turn) * d) and
/// scaled by the shader. No pixel is read.
[[nodiscard]] Plan plan_change(const BakeOptions& baked, const EnvironmentChange& change, const CostModel& costs = {});

/// Does that to `result.radiance` and, if it was made from harmonics, `result.irradiance`; `result.background`,
/// `result.specular` and an irradiance cubemap by direct convolution are left to the shader. Coefficients agree with
/// those of the changed pixels to rounding. Throws `Error` (invalid_argument) for a turn off orthogonal or a negative
/// factor, cancelled.
void apply_change(BakeResult& result, const BakeOptions& baked, const EnvironmentChange& change,
                  const Control& control = {});

/// A table of passes: action, predicted time and memory, reason. With `measured`, of the bake that was planned, also
/// what each took.
[[nodiscard]] std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured = {});
[[nodiscard]] std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured);

}  // namespace welkin
