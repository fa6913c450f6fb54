// The whole of image-based lighting in one call: all that a physically based renderer loads.
//
//   welkin::BakeResult light = welkin::bake(panorama, {.specular = welkin::PrefilterOptions{.size = 512}});
//   upload(light.specular->cubemap);  upload(*light.irradiance);  upload(*light.brdf);
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"

namespace WELKIN_EXPORT welkin {

enum class IrradianceMethod {
  /// Within `rms_error` of the integral over the source's texels; of a source that brings its harmonics along (an .env)
  /// from these, as its pixels hold less.
  automatic,
  direct,     ///< the integral itself: the reference, slow
  harmonics,  ///< from the coefficients: what shaders show that read so many bands
};

/// A sharp cubemap, for what is seen behind a scene.
struct BackgroundOptions {
  /// Texels along an edge, 1 to 16384. None: the specular cubemap's; without one the source's own, of a lat-long a
  /// quarter of its width.
  std::optional<int> size = std::nullopt;
  bool mips = true;                               ///< down to 1 texel; or level 0 alone
  MipFilter mip_filter = MipFilter::solid_angle;  ///< how each level is made from the one before

  friend bool operator==(const BackgroundOptions&, const BackgroundOptions&) = default;
};

/// A cubemap of the light that falls on a matte surface.
struct IrradianceOptions {
  int size = 64;                                          ///< texels along an edge, 1 to 4096
  IrradianceMethod method = IrradianceMethod::automatic;  ///< how it is computed; `harmonics` needs bands of them

  /// Of `automatic`: bound on the root mean square error over the root mean square of the irradiance, 1e-6 to 1. No
  /// channel of a texel errs by more than ten times that, relative to its own value, unless it is darker than
  /// 1e-7 / rms_error of that root mean square. Where a bake prefilters a specular chain by harmonics to this bound or
  /// a tighter one, irradiance is made of the same harmonics. Its bits then depend on the chain's options: on nothing
  /// but the options and the source, whatever a cache holds. Where the estimated error exceeds the bound, the integral
  /// itself is taken, or the bake ends with limit_exceeded if that would take more than a second.
  double rms_error = 1e-3;

  friend bool operator==(const IrradianceOptions&, const IrradianceOptions&) = default;
};

/// What a bake makes, and how. The default is all of it.
struct BakeOptions {
  std::optional<BackgroundOptions> background = BackgroundOptions{};  ///< none: no background

  /// None: no prefilter. Its `pixels` are not used, but those below.
  std::optional<PrefilterOptions> specular = PrefilterOptions{};

  /// The specular cubemap as an octahedral map as well, as `to_octahedral` makes it; none: no map. It needs `specular`,
  /// and no more levels than that has mips. A plan that leaves mips out has the map made of those that are left.
  std::optional<OctahedralOptions> octahedral = std::nullopt;

  std::optional<IrradianceOptions> irradiance = IrradianceOptions{};  ///< none: no irradiance cubemap

  /// Harmonic bands that are returned, and that an irradiance cubemap from harmonics is made from: 0 to kMaximumBands.
  int bands = 3;
  bool total_radiance =
      true;  ///< with 0 bands, still projects one, for the diagnostics' total radiance; else that is 0

  std::optional<BrdfTableOptions> brdf = BrdfTableOptions{};  ///< none: no table

  PixelPolicy pixels{};  ///< what becomes of the source's values first, for all passes alike

  /// Results and working memory together; a bake that may need more is refused before it begins.
  std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U;

  /// Returns the default options with the methods and bounds of a preset for reflections and irradiance:
  /// `BakeOptions::at(Quality::fast)`. They may be changed afterwards.
  [[nodiscard]] static BakeOptions at(Quality quality);

  friend bool operator==(const BakeOptions&, const BakeOptions&) = default;
};

/// What a bake made. What was not asked for is not there.
struct BakeResult {
  std::optional<Cubemap> background;            ///< radiance
  std::optional<PrefilteredSpecular> specular;  ///< reflections
  std::optional<OctahedralMap> octahedral;      ///< the same as an octahedral map
  std::optional<Cubemap> irradiance;            ///< W/m2 for W/m2/sr
  /// How the irradiance cubemap was made: as a mip of roughness 1, with its estimated error. From harmonics of `bands`,
  /// or of a stored file, there is no estimate. Its time is 0 where it was found in a cache.
  std::optional<MipRecord> irradiance_record;
  std::optional<SphericalHarmonics> radiance;  ///< coefficients: the very bits of `project` (of an .env: see below)
  std::shared_ptr<const BrdfTable> brdf;       ///< shared with other bakes; null if it was not asked for

  /// Of an .env file, as it is stored there, in Babylon.js's axes. Up to three bands of `radiance` and the irradiance
  /// cubemap come from it and not from the pixels, which end at 255.
  std::optional<BabylonPolynomial> stored_polynomial;

  /// Pixels read, replaced and clamped; total radiance and error estimate as `project` has them; each pass ("clean",
  /// "background", "background mips", "specular", "project", "irradiance", "brdf", where it is asked for "octahedral",
  /// of files "read" before them, of `bake_to` "store background" and so on after them) with its wall time: as passes
  /// overlap, times add up to more than the bake took.
  ProjectionDiagnostics diagnostics;
  std::uint64_t peak_bytes = 0;  ///< bound on results and working memory together: what `bake_bytes` says

  /// Of `bake_to`: channel values that the formats of the targets could not hold.
  std::uint64_t values_clamped = 0;
};

/// Memory of the caller's for the cubemaps of a bake, such as a mapped upload buffer. `upload_targets` makes the
/// targets of a chain.
struct BakeTargets {
  std::vector<CubemapTarget> background{};    ///< one a level; empty: the chain stays in the result
  std::vector<CubemapTarget> specular{};      ///< one a mip; empty: the chain stays in the result
  std::optional<CubemapTarget> irradiance{};  ///< none: the cubemap stays in the result
};

/// Memory that `bake` needs at most on the threads of the caller's arena, results included, source not. Throws `Error`
/// (invalid_argument) as `bake`.
[[nodiscard]] std::uint64_t bake_bytes(const EnvironmentView& source, const BakeOptions& options = {});

/// Bakes. Passes that do not wait for each other run at the same time, in the caller's arena; faces, mips and rows are
/// parallel inside each. The same bits on any number of threads and instruction set. Progress is one number over all
/// passes, weighed by what they are expected to cost. Throws `Error`: invalid_argument, rejected_pixel, limit_exceeded
/// (`bake_bytes` above the limit), cancelled; after any of them there is no result, and no pass still runs.
[[nodiscard]] BakeResult bake(const EnvironmentView& source, const BakeOptions& options = {},
                              const Control& control = {});

/// The same into an older result, whose background and specular cubemap keep their memory where sizes are the same:
/// fresh pages cost the system time. Memory that is kept stays that of the resource which
/// it came from, whatever `control.memory` says. After an exception `result` can only be baked into again, or freed.
void bake_into(BakeResult& result, const EnvironmentView& source, const BakeOptions& options = {},
               const Control& control = {});

/// The same with cubemaps in memory of the caller's: each is written to its targets, in their formats, as soon as it is
/// made, while other passes still run. The texels are those that `store_texels` writes. A background or an irradiance
/// cubemap that went to targets is absent from the result; `specular` then has its records and a chain without levels.
/// Nothing is written where a target is refused. Throws `Error` as `bake`, and invalid_argument for targets of another
/// size or number than the bake makes, or of a cubemap that the options leave out; after an exception targets may be
/// written in part.
[[nodiscard]] BakeResult bake_to(const BakeTargets& targets, const EnvironmentView& source,
                                 const BakeOptions& options = {}, const Control& control = {});

// Many at once: the probes of a level, each with its coefficients and reflections
//
//   const welkin::PrefilterOptions options{.size = 64, .mips = 5};
//   std::vector<welkin::CubemapTarget> targets;             // five a probe, in memory of the caller's
//   std::vector<welkin::dvec3> light(9 * probes.size());    // nine a probe
//   welkin::bake_many(probes, targets, light, options);

/// Bakes reflections and harmonics of many cubemaps, of any sizes and formats, into memory of the caller's. `specular`:
/// the targets of each mip of the first probe's chain, then of the second's, and so on; texels are those that
/// `store_texels` writes of `prefilter_specular`. `coefficients`: bands^2 of each probe, as `project_many` writes them;
/// with 0 bands none. `options` and its pixel policy are those of all probes.
///
/// Small probes (to 129 texels an edge) are baked whole by one thread each, side by side, if there are two or more for
/// each thread; others one after the other by all threads. The result has no cubemaps: its diagnostics are as
/// `project_many` has them, `values_clamped` is of all targets, `peak_bytes` of the working memory of all threads. The
/// same bits as single calls, on any number of threads.
///
/// Throws `Error` as `bake` and `bake_to`, the message beginning with the number of the first probe that is refused or
/// rejected. Arguments are looked at before anything is written; after other errors what was written is any.
BakeResult bake_many(std::span<const CubemapView> probes, std::span<const CubemapTarget> specular,
                     std::span<dvec3> coefficients, const PrefilterOptions& options = {}, int bands = 3,
                     const Control& control = {});

// ---- Plans: what a scene uses of its environment, and what a bake will do for it
//
//   welkin::SceneNeeds mobile{.diffuse_bands = 1, .glossy = std::nullopt, .background = false};
//   welkin::Plan plan = welkin::plan(panorama, mobile);

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

/// Returns the shape of a view. Throws `Error` (invalid_argument) for one that no call would accept.
[[nodiscard]] SourceShape shape_of(const EnvironmentView& view);

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
[[nodiscard]] Plan plan(const EnvironmentView& source, const SceneNeeds& needs, const BakeOptions& whole = {});

/// Carries a plan out; the source must have the shape that was planned for. The records' reasons are the plan's. Throws
/// as `bake`, and invalid_argument for another source.
[[nodiscard]] BakeResult bake(const EnvironmentView& source, const Plan& plan, const Control& control = {});

/// A table of passes: action, memory, reason. With `measured`, the records of the bake that was planned, also the time
/// that each took.
[[nodiscard]] std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured = {});
[[nodiscard]] std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured);

// ---- Skies: reflections of a computed sky, and plans for skies

/// A sky cubemap of `options.size` prefiltered as `prefilter_specular` does; the sun's disc is left out unless asked
/// for. Throws `Error`: invalid_argument, limit_exceeded, cancelled.
[[nodiscard]] PrefilteredSpecular sky_specular(const SkyView& view, const dvec3& sun, const PrefilterOptions& options,
                                               const SkyPictureOptions& picture = {}, const Control& control = {});

// Plans for computed skies: which tables, and what of the light.
//
//   const welkin::SkyPlan plan = welkin::plan(welkin::earth(), {.glossy = std::nullopt});
//   const welkin::SkyBake sky = welkin::bake(plan, welkin::sun_direction(20.0, 145.0));
//   const auto light = sky.curve->at(sun);    // each frame

/// What is baked of a sky.
struct SkyBakeOptions {
  SkyTableOptions tables{};         ///< sizes and orders of the tables
  double altitude_m = 0.0;          ///< the observer's, above the ground
  int bands = 3;                    ///< 0 to kMaximumBands; those of `curve` and `harmonics` are not read
  SkyCurveOptions curve{};          ///< of a sun that moves
  SkyHarmonicsOptions harmonics{};  ///< of one that does not
  std::optional<PrefilterOptions> specular = PrefilterOptions{.size = 32};  ///< reflections; none: not made
  /// Texels along an edge of a sharp cubemap of the sky, at least 1; none: not made.
  std::optional<int> background_size = 256;
  std::optional<BrdfTableOptions> brdf = BrdfTableOptions{};  ///< the BRDF table; none: not made

  friend bool operator==(const SkyBakeOptions&, const SkyBakeOptions&) = default;
};

/// What a bake of a sky would do.
struct SkyPlan {
  Atmosphere atmosphere;            ///< as it was given
  std::string source;               ///< for a person
  std::vector<PlannedPass> passes;  ///< of the tables as `SkyTables::passes` names them, and what follows
  SkyBakeOptions options;           ///< what the scene does not need is left out of them
  int specular_source = 0;          ///< texels along an edge of the sky that the reflections are prefiltered from
  bool tables = true;               ///< whether anything looks into them
  bool curve = false;               ///< harmonics over the sun's elevation; or of one sun, if there are bands
  std::uint64_t result_bytes = 0;   ///< memory of the results

  /// By its name. Throws `Error` (invalid_argument) if there is none.
  [[nodiscard]] const PlannedPass& pass(const std::string& name) const;
};

/// Plans a sky. Work for what the planet lacks is left out: without aerosol the second table of scattering, without
/// absorbers their shells, with one order the sources of the others. Throws `Error`
/// (invalid_argument) as `check` and `precompute_sky`.
[[nodiscard]] SkyPlan plan(const Atmosphere& atmosphere, const SceneNeeds& needs, const SkyBakeOptions& whole = {});

/// The results. What was not planned is empty.
struct SkyBake {
  std::shared_ptr<const SkyTables> tables;      ///< null if nothing is needed
  std::optional<SkyCurve> curve;                ///< of a sun that moves
  std::optional<SphericalHarmonics> radiance;   ///< of one that does not: what `SkyProjector` gives
  Sun sun;                                      ///< as a directional light
  std::optional<PrefilteredSpecular> specular;  ///< for this sun; about the vertical it can be turned
  std::optional<Cubemap> background;            ///< the sky as a sharp cubemap
  std::shared_ptr<const BrdfTable> brdf;        ///< null: not made
  std::vector<PassRecord> passes;  ///< in the plan's order; of tables for more wavelengths than three some come again
};

/// Carries it out, for one sun. The same bits on any number of threads. Throws `Error` as the calls that it makes.
[[nodiscard]] SkyBake bake(const SkyPlan& plan, const dvec3& sun, const Control& control = {});

/// As above.
[[nodiscard]] std::string plan_text(const SkyPlan& plan, const std::vector<PassRecord>& measured = {});

}  // namespace welkin
