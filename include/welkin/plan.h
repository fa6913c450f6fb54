// What a scene uses of its environment: what it does not use need not be baked.
//
//   welkin::SceneNeeds mobile{.diffuse_bands = 1, .glossy = std::nullopt, .background = false};
//   welkin::Plan plan = welkin::plan(panorama, mobile);
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

/// Perceptual roughness, as artists set it.
struct RoughnessRange {
  double minimum = 0.0;  ///< of the smoothest material
  double maximum = 1.0;  ///< of the roughest material

  friend bool operator==(const RoughnessRange&, const RoughnessRange&) = default;
};

/// The default uses everything, of diffuse light what three bands hold.
struct SceneNeeds {
  int diffuse_bands = 3;  ///< of diffuse light: 0 none is used, 1 ambient only, 3 as a rule; up to kMaximumBands
  bool irradiance_cubemap = true;  ///< shaders look diffuse light up in a cubemap; else coefficients are all they read

  /// Of all materials that reflect their surroundings; none: there are no glossy materials.
  std::optional<RoughnessRange> glossy = RoughnessRange{};

  bool background = true;       ///< something shows the environment itself
  bool background_mips = true;  ///< and shows it from afar, or blurred
  bool brdf_table = true;       ///< glossy materials read it; else the engine has one

  /// What an input file carries is taken as it is: the polynomial and the prefiltered chain of an .env, the levels of
  /// a KTX2. Off: it is computed from the pixels.
  bool stored_results = true;

  bool sun_moves = true;  ///< of a computed sky: a curve over the sun's elevation; else the light of one sun

  friend bool operator==(const SceneNeeds&, const SceneNeeds&) = default;
};

/// Throws `Error` (invalid_argument) that names the member unless 0 <= diffuse_bands <= kMaximumBands and 0 <= minimum
/// <= maximum <= 1.
void check(const SceneNeeds& needs);

// What a source of light looks like from outside: all that a plan needs to know of its pixels.

/// Size and format of pixels that are not there yet, for plans.
struct SourceShape {
  bool cubemap = false;                      ///< or a lat-long
  int columns = 0;                           ///< of a lat-long, or of a face
  int rows = 0;                              ///< of a lat-long, or of six faces
  PixelFormat format = PixelFormat::rgb32f;  ///< of the pixels

  /// How many texels there are.
  [[nodiscard]] std::uint64_t texels() const noexcept {
    return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  }
  /// "lat-long 1024 x 512", "cubemap of 256"
  [[nodiscard]] std::string words() const;

  friend bool operator==(const SourceShape&, const SourceShape&) = default;
};

/// Throw `Error` (invalid_argument) for a view that no call would accept.
[[nodiscard]] SourceShape shape_of(const LatLongView& view);
[[nodiscard]] SourceShape shape_of(const CubemapView& view);

// A step of a plan: what will be done, or why it will not.

/// What becomes of one pass, and why.
struct PlannedPass {
  std::string name;                     ///< as the `PassRecord` that comes out of it
  PassAction action = PassAction::run;  ///< run, reused or left out
  std::string reason;                   ///< what is done, or why it is not; for a person

  std::uint64_t bytes = 0;  ///< what it holds at most beside the source: its result, and its working memory

  friend bool operator==(const PlannedPass&, const PlannedPass&) = default;
};

// What a bake will do for a scene, before any of it is done: which passes run, which are there already, which nobody
// needs, why, and how much memory each takes.
//
//   const welkin::Plan plan = welkin::plan(panorama, {.glossy = std::nullopt});
//   log(welkin::plan_text(plan));
//   const welkin::BakeResult light = welkin::bake(panorama, plan);

/// What a bake would do, before it does it.
struct Plan {
  std::string source;               ///< "lat-long 1024 x 512"; of files with their name
  std::vector<PlannedPass> passes;  ///< in the order of the records that come out; of files "read" first

  BakeOptions options;         ///< the whole bake's, without the parts that the scene does not use
  bool take_specular = false;  ///< the file's chain is the result's
  bool take_levels = false;    ///< the file's levels are the background's mips
  int first_stored_mip = 0;    ///< of that chain: the first that is used,
  int stored_mips = 0;         ///< and how many are
  bool take_light = false;     ///< the file's polynomial is the diffuse light
  bool streams = false;  ///< nothing but its light is wanted: it is projected while it is read, or not read at all

  std::uint64_t result_bytes = 0;   ///< memory of the results
  std::uint64_t working_bytes = 0;  ///< at most, beside results and source

  /// Throws `Error` (invalid_argument) if no pass has the name.
  [[nodiscard]] const PlannedPass& pass(const std::string& name) const;
};

/// Plans a bake. `whole` describes the bake of everything, with its sizes and bounds; the parts that `needs` does not
/// use are removed from it. The reflections become a chain of the mips that are left, and the light has as many bands
/// as are used. Throws `Error` (invalid_argument, limit_exceeded) as `bake` and `check`.
[[nodiscard]] Plan plan(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& whole = {});
[[nodiscard]] Plan plan(const LatLongView& source, const SceneNeeds& needs, const BakeOptions& whole = {});
[[nodiscard]] Plan plan(const CubemapView& source, const SceneNeeds& needs, const BakeOptions& whole = {});

/// Carries a plan out; the source must have the shape that was planned for. The records' reasons are the plan's. Throws
/// as `bake`, and invalid_argument for another source.
[[nodiscard]] BakeResult bake(const LatLongView& source, const Plan& plan, const Control& control = {});
[[nodiscard]] BakeResult bake(const CubemapView& source, const Plan& plan, const Control& control = {});

/// A table of passes: action, memory, reason. With `measured`, the records of the bake that was planned, also the time
/// that each took.
[[nodiscard]] std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured = {});
[[nodiscard]] std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured);

}  // namespace welkin
