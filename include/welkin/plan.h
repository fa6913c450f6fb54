// What a scene uses of its environment: what it does not use need not be baked.
//
//   welkin::SceneNeeds mobile{.diffuse_bands = 1, .glossy = std::nullopt, .background = false};
//   welkin::Plan plan = welkin::plan(panorama, mobile);
#pragma once

#include <cstdint>
#include <optional>
#include <span>
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

  /// What is left is the very bits of a bake of everything (an irradiance cubemap from harmonics: of a bake with so
  /// many bands, `diffuse_bands` being all that it is evaluated from). Off: a chain of mips is planned for the
  /// roughness that there is alone, within the same bounds of error; of a cubemap that may be several times faster.
  bool same_bits = true;

  /// What each pass may lose, relative: 0.01 is 1 %, 1e-6 to 1. Each picks its cheapest setting whose estimated error
  /// on this environment is under it (rms over the sphere over the rms of the result; error_budget.h), or stays as it
  /// is where no estimate is. `same_bits` does not hold then, and nothing stored is taken: its error is unknown. Only
  /// plans of pixels can tell. None: nothing is lost beyond the bounds of the options.
  std::optional<double> error_budget = std::nullopt;

  bool sun_moves = true;  ///< of a computed sky: a curve over the sun's elevation; else the light of one sun

  friend bool operator==(const SceneNeeds&, const SceneNeeds&) = default;
};

/// Throws `Error` (invalid_argument) that names the member unless 0 <= diffuse_bands <= kMaximumBands, 0 <= minimum <=
/// maximum <= 1, and 1e-6 <= error_budget <= 1.
void check(const SceneNeeds& needs);

// What each kind of work costs on a machine: nanoseconds of one thread a unit.
//
//   welkin::CostModel costs;   // the stored numbers; or what `welkin report --calibrate` has measured here
//   welkin::Plan plan = welkin::plan(panorama, needs, {}, costs);

/// The stored numbers are estimates from benchmarks of single passes: their ratios hold roughly, their sum is another
/// on every machine, which is what `welkin report --calibrate` is for. They predict, they never decide a result's bits.
struct CostModel {
  // Of a source's pixels.
  double clean_texel = 0.27;            ///< looked through, or copied as RGB floats
  double project_texel = 0.43;          ///< read for harmonics,
  double project_sum = 0.024;           ///< and each of its n (n + 1) / 2 sums for n bands
  double resample_texel = 5.3;          ///< a texel of a cubemap by area,
  double resample_source = 0.88;        ///< and a texel of the source that goes into it
  double resample_cube_texel = 290.0;   ///< the same where the source is a cubemap, too, of another size:
  double resample_cube_source = 450.0;  ///< faces do not line up with rows, and outlines are cut
  double mip_texel = 1.0;               ///< a texel of level 0, for all levels below it
  double copy_texel = 0.25;             ///< a texel of a result that is copied
  double read_texel = 12.5;             ///< of a file, compressed: OpenEXR, .hdr, PNG, .env
  double read_plain_texel = 1.9;        ///< of a file, as it is: PFM, KTX2, DDS

  // Of the prefilter.
  double ring_texel = 3.5;             ///< a texel of the lat-long that a cubemap goes through
  double bright_texel = 0.18;          ///< a texel of the source that is looked at for its own brightness
  double fourier_texel = 1.7;          ///< a texel of a ring, transformed either way
  double legendre_term = 0.37;         ///< a ring's share of one degree and order, either way, three channels
  double face_texel = 8.0;             ///< a texel of a mip, looked up in rings
  double near_texel = 1000.0;          ///< a texel of a narrow mip: a cubemap's texels near by, each as an area
  double reference_pair = 26.0;        ///< a texel of the source for a texel of the reference method,
  double reference_direction = 2.6e6;  ///< and once for each of these: source texels near its peak are divided

  // Of diffuse light and the table.
  double irradiance_term = 0.55;        ///< a coefficient of a texel of the irradiance cubemap
  double irradiance_pair = 4.1;         ///< a texel of the source for a texel of direct convolution,
  double irradiance_direction = 2.0e5;  ///< and once for each of these: source texels near its horizon are divided
  double brdf_texel = 300.0;            ///< of the table, without sheen
  double sheen_texel = 630.0;           ///< and with

  // Of a sky, for three wavelengths.
  double transmittance_texel = 1800.0;  ///< of the transmittance table
  double sun_path_node = 1700.0;        ///< of the lengths to the sun that all wavelengths share
  double first_order_node = 3300.0;     ///< of the radiance of the first order, by height, direction and sun
  double order_node = 2400.0;           ///< of each order above
  double scattered_once = 205.0;        ///< a texel of the scattering table: light from the sun itself,
  double scattered_often = 123.0;       ///< and all other light
  double slice_texel = 400.0;           ///< a texel of a scattering table that a view's slice is made from
  double sky_direction = 39.0;          ///< a direction looked up
  double projected_direction = 8.1;     ///< a direction of a curve's node

  friend bool operator==(const CostModel&, const CostModel&) = default;
};

/// One of its numbers.
struct CostUnit {
  const char* name;          ///< the member's
  double CostModel::*value;  ///< the member that holds it
};

/// All of them, in order: for files and tables.
[[nodiscard]] std::span<const CostUnit> cost_units() noexcept;

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

  /// Processor time of one thread; 0 for what is skipped. Passes overlap and share threads: `Plan::milliseconds`.
  double predicted_milliseconds = 0.0;
  std::uint64_t bytes = 0;  ///< what it holds at most beside the source: its result, and its working memory

  friend bool operator==(const PlannedPass&, const PlannedPass&) = default;
};

// What a bake will do for a scene, before any of it is done: which passes run, which are there already, which nobody
// needs, why, and what each is expected to cost.
//
//   const welkin::Plan plan = welkin::plan(panorama, {.glossy = std::nullopt});
//   log(welkin::plan_text(plan));
//   const welkin::BakeResult light = welkin::bake(panorama, plan);

/// Mips at the ends of a prefiltered chain that no lookup touches, so that they are not made. The others have the bits
/// that they have in the whole chain. (A smaller chain of the same roughness would have others within the bounds.)
struct UnusedMips {
  int sharp = 0;  ///< so many at the sharp end: level 0 of the result has size >> sharp texels along an edge
  int rough = 0;  ///< so many at the rough end; one mip at least stays

  friend bool operator==(const UnusedMips&, const UnusedMips&) = default;
};

/// What a plan does other than its options say, so that results have the bits of the whole bake.
struct PlanTrim {
  UnusedMips mips{};  ///< of the chain that `options.specular` describes

  /// If above `options.bands`: so many bands are projected, and the first `options.bands` of them are returned. A
  /// projection of fewer bands rounds otherwise. 0: where no bands are returned nothing is projected either, and the
  /// diagnostics' total radiance is 0.
  int projected_bands = 1;

  friend bool operator==(const PlanTrim&, const PlanTrim&) = default;
};

/// What a bake would do, before it does it.
struct Plan {
  std::string source;               ///< "lat-long 1024 x 512"; of files with their name
  std::vector<PlannedPass> passes;  ///< in the order of the records that come out; of files "read" first

  BakeOptions options;         ///< that do it: what the scene does not need is left out of them
  PlanTrim trim{};             ///< and what else is left out
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
/// those that are needed, the prefilter's bounds if its method is automatic, and an irradiance cubemap's bound is no
/// wider than the budget; the projection, the background and the
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
  dmat3 turn{1.0};   ///< orthogonal
  dvec3 scale{1.0};  ///< of red, green and blue: exposure; not negative
};

/// What such a change costs a result that was baked with `baked`: coefficients are turned and scaled, an irradiance
/// cubemap from harmonics is evaluated anew, and cubemaps stay: lookups are turned back (transpose(turn) * d) and
/// scaled by the shader. No pixel is read.
[[nodiscard]] Plan plan_change(const BakeOptions& baked, const EnvironmentChange& change, const CostModel& costs = {});

/// Does that to `result.radiance` and, if it was made from harmonics, `result.irradiance`; `result.background`,
/// `result.specular` and an irradiance cubemap that was made from pixels are left to the shader. Coefficients agree
/// with those of the changed pixels to rounding. Throws `Error` (invalid_argument) for a turn off orthogonal or a
/// negative factor, cancelled.
void apply_change(BakeResult& result, const BakeOptions& baked, const EnvironmentChange& change,
                  const Control& control = {});

/// A table of passes: action, predicted time and memory, reason. With `measured`, of the bake that was planned, also
/// what each took.
[[nodiscard]] std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured = {});
[[nodiscard]] std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured);

}  // namespace welkin
