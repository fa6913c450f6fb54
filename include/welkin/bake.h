// Complete image-based lighting in one call, and plans that leave out what a scene does not use.
//
//   welkin::BakeResult light = welkin::bake(panorama, {.specular = welkin::PrefilterOptions{.size = 512}});
//   upload(light.specular->cubemap);  upload(*light.irradiance);  upload(*light.brdf);
//
// Which call to use:
// - `bake` returns a new result; `bake_into` reuses the memory of an older one.
// - `bake_to` writes cubemaps into the caller's memory, in GPU formats.
// - `bake_many` bakes specular chains and harmonics of many probes.
// - `Bake` and `BakeTo` (requests.h) do the same on a worker's threads; `bake_file` and `BakeFile` (bake_file.h) read a
//   file.
// - `ResultCache::bake` (result_cache.h) keeps results on disk.
// - `bake` with a `Plan` omits the passes that a scene does not need.
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
  /// Within `rms_error` of the integral over the source's texels. For sources that come with harmonics (an .env file),
  /// computed from those, because the file's pixels are clamped.
  automatic,
  direct,     ///< the integral over the source's texels; slow
  harmonics,  ///< from the returned coefficients, to match shaders that evaluate the same number of bands
};

/// A sharp cubemap of the environment: the skybox.
struct BackgroundOptions {
  /// Texels per edge, 1 to 16384. If empty: the specular cubemap's size; without one, the source's face size, or a
  /// quarter of a lat-long's width.
  std::optional<int> size = std::nullopt;
  bool mips = true;                               ///< makes mips down to 1 texel; otherwise level 0 only
  MipFilter mip_filter = MipFilter::solid_angle;  ///< filter with which each level is made from the one before

  friend bool operator==(const BackgroundOptions&, const BackgroundOptions&) = default;
};

/// A cubemap of the irradiance at diffuse surfaces.
struct IrradianceOptions {
  int size = 64;                                          ///< texels per edge, 1 to 4096
  IrradianceMethod method = IrradianceMethod::automatic;  ///< how it is computed; `harmonics` needs at least one band

  /// Bound of `automatic` on the root mean square error divided by the root mean square of the irradiance, 1e-6 to 1.
  /// The relative error of any channel of a texel is at most ten times the bound, unless the channel is darker than
  /// 1e-7 / rms_error of that root mean square.
  ///
  /// If the bake prefilters a specular chain by harmonics to this bound or a tighter one, irradiance is made from the
  /// same harmonics. Its bits then depend on the chain's options, but never on the contents of a cache. If the
  /// estimated error exceeds the bound, the integral is computed instead. If that would take more than a second, the
  /// bake throws `Error` (limit_exceeded).
  double rms_error = 1e-3;

  friend bool operator==(const IrradianceOptions&, const IrradianceOptions&) = default;
};

/// Parts, sizes and bounds of a bake. The default makes everything except an octahedral map.
struct BakeOptions {
  std::optional<BackgroundOptions> background = BackgroundOptions{};  ///< skybox; empty for none

  /// Specular cubemap; empty for none. Its `pixels` are ignored in favour of `BakeOptions::pixels`.
  std::optional<PrefilterOptions> specular = PrefilterOptions{};

  /// Octahedral map of the specular cubemap, as made by `to_octahedral`; empty for none. It requires `specular`, and
  /// may have at most as many levels as that has mips. With a plan that leaves mips out, the map is made from the
  /// remaining ones.
  std::optional<OctahedralOptions> octahedral = std::nullopt;

  std::optional<IrradianceOptions> irradiance = IrradianceOptions{};  ///< irradiance cubemap; empty for none

  /// Harmonic bands of `BakeResult::radiance`, and of an irradiance cubemap from harmonics: 0 to kMaximumBands.
  int bands = 3;
  /// With 0 bands, still projects one for the diagnostics' total radiance, which is 0 otherwise.
  bool total_radiance = true;

  std::optional<BrdfTableOptions> brdf = BrdfTableOptions{};  ///< BRDF lookup table; empty for none

  PixelPolicy pixels{};  ///< treatment of source values, for all passes

  /// Limit on results and working memory together. A bake that may exceed it throws before it begins.
  std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U;

  /// Returns the default options with the methods and bounds of a preset for reflections and irradiance, as in
  /// `BakeOptions::at(Quality::fast)`. They may be changed afterwards.
  [[nodiscard]] static BakeOptions at(Quality quality);

  friend bool operator==(const BakeOptions&, const BakeOptions&) = default;
};

/// Result of a bake. Members that were not requested are empty.
struct BakeResult {
  std::optional<Cubemap> background;            ///< radiance
  std::optional<PrefilteredSpecular> specular;  ///< prefiltered radiance
  std::optional<OctahedralMap> octahedral;      ///< the specular cubemap as an octahedral map
  std::optional<Cubemap> irradiance;            ///< W/m2 where radiance is W/m2/sr
  /// How the irradiance cubemap was made, as a mip of roughness 1 with its estimated error. There is no estimate for
  /// irradiance from the returned harmonics or from a file. The time is 0 for a result from a cache.
  std::optional<MipRecord> irradiance_record;
  std::optional<SphericalHarmonics> radiance;  ///< bit-identical to `project` (for .env files see below)
  std::shared_ptr<const BrdfTable> brdf;       ///< shared with other bakes; null if not requested

  /// Polynomial of an .env file as stored, in Babylon.js's axes. Up to three bands of `radiance` and the irradiance
  /// cubemap are computed from it, because the file's pixels are clamped at 255.
  std::optional<BabylonPolynomial> stored_polynomial;

  /// Counts of pixels read, replaced and clamped; total radiance and error estimate as in `project`; and the wall time
  /// of each pass: "sanitize", "background", "background mips", "specular", "project", "irradiance", "brdf" and, if
  /// requested, "octahedral". Calls that read files add "read" before them, `bake_to` "store background" and so on
  /// after them. Passes overlap, so the times add up to more than the bake took.
  ProjectionDiagnostics diagnostics;
  std::uint64_t peak_bytes = 0;  ///< bound on results and working memory together, as returned by `bake_bytes`

  /// Channel values that `bake_to` clamped because the targets' formats could not hold them.
  std::uint64_t values_clamped = 0;
};

/// Memory of the caller for the cubemaps of a bake, such as a mapped upload buffer. `upload_targets` makes the targets
/// of a chain.
struct BakeTargets {
  std::vector<CubemapTarget> background{};    ///< one per level; if empty, the chain is in the result
  std::vector<CubemapTarget> specular{};      ///< one per mip; if empty, the chain is in the result
  std::optional<CubemapTarget> irradiance{};  ///< if empty, the cubemap is in the result
};

/// Returns the memory in bytes that `bake` needs at most on the threads of the caller's arena, including results but
/// not the source. Throws `Error` (invalid_argument) for arguments that `bake` refuses.
[[nodiscard]] std::uint64_t bake_bytes(const EnvironmentView& source, const BakeOptions& options = {});

/// Bakes an environment. Independent passes run concurrently in the caller's arena, and each pass is parallel over
/// faces, mips and rows. Progress covers all passes, weighted by their expected cost.
///
/// Throws `Error`: invalid_argument, rejected_pixel, limit_exceeded (`bake_bytes` above the limit, or an error bound
/// that cannot be met). No pass is running any more when it throws.
[[nodiscard]] BakeResult bake(const EnvironmentView& source, const BakeOptions& options = {},
                              const Control& control = {});

/// Bakes into an older result. Its background and specular cubemaps keep their memory where sizes match, which saves
/// the cost of fresh pages. Kept memory belongs to the resource that allocated it, not to `control.memory`. After
/// an exception, `result` can only be baked into again or destroyed. Throws the same errors as `bake`.
void bake_into(BakeResult& result, const EnvironmentView& source, const BakeOptions& options = {},
               const Control& control = {});

/// Bakes with cubemaps in the caller's memory: each is written to its targets as soon as it is made, while other passes
/// still run. Texels are those that `store_texels` writes. The result omits a background or irradiance cubemap that was
/// written to targets. For a specular chain in targets, it has the records and an empty cubemap.
///
/// Throws the same errors as `bake`. Also throws `Error` (invalid_argument), before anything is written, for targets
/// whose size or number differs from what the bake makes, and for targets of a cubemap that the options leave out.
/// After any other exception, targets may be partly written.
[[nodiscard]] BakeResult bake_to(const BakeTargets& targets, const EnvironmentView& source,
                                 const BakeOptions& options = {}, const Control& control = {});

// Many probes at once, each with its coefficients and specular chain
//
//   const welkin::PrefilterOptions options{.size = 64, .mips = 5};
//   std::vector<welkin::CubemapTarget> targets;             // five per probe, in the caller's memory
//   std::vector<welkin::dvec3> light(9 * probes.size());    // nine per probe
//   welkin::bake_many(probes, targets, light, options);

/// Bakes specular chains and harmonics of many cubemaps, of any sizes and formats, into the caller's memory. `specular`
/// lists the targets of all mips of the first probe, then of the second, and so on; texels are those that
/// `prefilter_specular` and `store_texels` would write. `coefficients` receives bands^2 values per probe, as from
/// `project_many`; with 0 bands it is empty. `options` and its pixel policy apply to all probes.
///
/// If there are at least two probes per thread, probes up to 129 texels per edge are baked by one thread each; all
/// others are baked one after the other on all threads. The result has no cubemaps. Its diagnostics are those of
/// `project_many`, `values_clamped` covers all targets, and `peak_bytes` the working memory of all threads. Bits are
/// those of single calls.
///
/// Throws the same errors as `bake` and `bake_to`; messages start with the index of the first offending probe. After
/// any error except invalid_argument the contents of targets and coefficients are unspecified.
BakeResult bake_many(std::span<const CubemapView> probes, std::span<const CubemapTarget> specular,
                     std::span<dvec3> coefficients, const PrefilterOptions& options = {}, int bands = 3,
                     const Control& control = {});

// ---- Plans: the passes that a bake runs for what a scene uses of its environment
//
//   welkin::SceneNeeds mobile{.diffuse_bands = 1, .glossy = std::nullopt, .background = false};
//   welkin::Plan plan = welkin::plan(panorama, mobile);

/// A range of perceptual roughness.
struct RoughnessRange {
  double minimum = 0.0;  ///< roughness of the smoothest material
  double maximum = 1.0;  ///< roughness of the roughest material

  friend bool operator==(const RoughnessRange&, const RoughnessRange&) = default;
};

/// The parts of an environment that a scene uses. The default uses everything, with diffuse light from three bands.
struct SceneNeeds {
  int diffuse_bands = 3;  ///< bands of diffuse light, usually 3; 1 is ambient only, 0 none; up to kMaximumBands
  bool irradiance_cubemap = true;  ///< shaders look diffuse light up in a cubemap; otherwise they use coefficients only

  /// Roughness of all reflective materials; empty if there are none.
  std::optional<RoughnessRange> glossy = RoughnessRange{};

  bool background = true;       ///< the environment itself is visible
  bool background_mips = true;  ///< the environment is visible from afar or blurred
  bool brdf_table = true;       ///< glossy materials need the table; false if the engine has its own

  /// Uses what an input file contains: the polynomial and the prefiltered chain of an .env, the levels of a KTX2. False
  /// computes everything from the pixels.
  bool stored_results = true;

  /// for a computed sky, bakes a curve over the sun's elevation; otherwise the light of one sun
  bool sun_moves = true;

  friend bool operator==(const SceneNeeds&, const SceneNeeds&) = default;
};

/// Checks that 0 <= diffuse_bands <= kMaximumBands and 0 <= minimum <= maximum <= 1. Throws `Error` (invalid_argument)
/// that names the offending member.
void check(const SceneNeeds& needs);

/// Size and format of a source, for plans that are made before its pixels exist.
struct SourceShape {
  bool cubemap = false;                      ///< true: a cubemap; false: a lat-long
  int columns = 0;                           ///< width of a lat-long, or of one face
  int rows = 0;                              ///< height of a lat-long, or of all six faces together
  PixelFormat format = PixelFormat::rgb32f;  ///< format of the pixels

  /// Returns the number of texels.
  [[nodiscard]] std::uint64_t texels() const noexcept {
    return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  }
  /// Returns a description such as "lat-long 1024 x 512" or "cubemap of 256".
  [[nodiscard]] std::string description() const;

  friend bool operator==(const SourceShape&, const SourceShape&) = default;
};

/// Returns the shape of a view. Throws `Error` (invalid_argument) for an invalid view.
[[nodiscard]] SourceShape shape_of(const EnvironmentView& view);

/// One step of a plan: what happens to a pass, and why.
struct PlannedPass {
  std::string name;                     ///< name of the pass in `PassRecord`
  PassAction action = PassAction::run;  ///< run, reused or skipped
  std::string reason;                   ///< what is done, or why it is not; for people

  std::uint64_t bytes = 0;  ///< memory of its result and working memory at most, without the source

  friend bool operator==(const PlannedPass&, const PlannedPass&) = default;
};

// A plan states before a bake which passes run, which results exist already, which are not needed, why, and how much
// memory each pass takes.
//
//   const welkin::Plan plan = welkin::plan(panorama, {.glossy = std::nullopt});
//   log(welkin::plan_text(plan));
//   const welkin::BakeResult light = welkin::bake(panorama, plan);

/// The passes of a bake, made before it runs.
struct Plan {
  std::string source;               ///< such as "lat-long 1024 x 512"; for files with their name
  std::vector<PlannedPass> passes;  ///< in the order of the resulting records; for files "read" comes first

  BakeOptions options;         ///< options of the whole bake, without the parts that the scene does not use
  bool take_specular = false;  ///< the chain in the file is used as the result
  bool take_levels = false;    ///< the levels in the file are used as the background's mips
  int first_stored_mip = 0;    ///< first mip of the file's chain that is used
  int stored_mips = 0;         ///< number of mips of the file's chain that are used
  bool take_light = false;     ///< the polynomial in the file is used for diffuse light
  bool streams = false;  ///< only harmonics are needed: the file is projected while it is read, or not read at all

  std::uint64_t result_bytes = 0;   ///< memory of the results
  std::uint64_t working_bytes = 0;  ///< working memory at most, without results and source

  /// Returns the pass with a name. Throws `Error` (invalid_argument) if there is none.
  [[nodiscard]] const PlannedPass& pass(const std::string& name) const;
};

/// Plans a bake. `full_options` describes the bake of everything, with its sizes and bounds. Parts that `needs` does
/// not use are removed from it; the specular chain keeps the mips that are needed, and harmonics the bands that are
/// needed. Throws `Error` (invalid_argument, limit_exceeded) where `bake` or `check` would.
[[nodiscard]] Plan plan(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& full_options = {});
[[nodiscard]] Plan plan(const EnvironmentView& source, const SceneNeeds& needs, const BakeOptions& full_options = {});

/// Bakes according to a plan. The source must have the shape that was planned for. The records have the plan's reasons.
/// Throws the same errors as `bake`, and `Error` (invalid_argument) for another shape.
[[nodiscard]] BakeResult bake(const EnvironmentView& source, const Plan& plan, const Control& control = {});

/// Formats a table of passes: action, memory, reason. If `measured` has the records of the bake, the table includes the
/// time of each pass.
[[nodiscard]] std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured = {});

// ---- Skies: specular chains of a computed sky, and plans for skies

/// Computes a sky cubemap of `options.size` and prefilters it as `prefilter_specular` does. The sun's disc is included
/// only if `image` requests it. Throws `Error`: invalid_argument, limit_exceeded.
[[nodiscard]] PrefilteredSpecular sky_specular(const SkyView& view, const dvec3& sun, const PrefilterOptions& options,
                                               const SkyImageOptions& image = {}, const Control& control = {});

// Plans for computed skies
//
//   const welkin::SkyPlan plan = welkin::plan(welkin::earth(), {.glossy = std::nullopt});
//   const welkin::SkyBake sky = welkin::bake(plan, welkin::sun_direction(20.0, 145.0));
//   const auto light = sky.curve->at(sun);    // each frame

/// Parts, sizes and bounds of a sky bake.
struct SkyBakeOptions {
  SkyTableOptions tables{};         ///< sizes of the tables and orders of scattering
  double altitude_m = 0.0;          ///< altitude of the observer above the ground
  int bands = 3;                    ///< 0 to kMaximumBands; replaces the bands of `curve` and `harmonics`
  SkyCurveOptions curve{};          ///< harmonics for a moving sun
  SkyHarmonicsOptions harmonics{};  ///< harmonics for a fixed sun
  std::optional<PrefilterOptions> specular = PrefilterOptions{.size = 32};  ///< specular cubemap; empty for none
  /// Texels per edge of a sharp cubemap of the sky, at least 1; empty for none.
  std::optional<int> background_size = 256;
  std::optional<BrdfTableOptions> brdf = BrdfTableOptions{};  ///< BRDF lookup table; empty for none

  friend bool operator==(const SkyBakeOptions&, const SkyBakeOptions&) = default;
};

/// The passes of a sky bake, made before it runs.
struct SkyPlan {
  Atmosphere atmosphere;            ///< the atmosphere as given
  std::string source;               ///< description, for people
  std::vector<PlannedPass> passes;  ///< passes of the tables, as in `SkyTables::passes`, and those after them
  SkyBakeOptions options;           ///< options without the parts that the scene does not use
  int specular_source = 0;          ///< texels per edge of the sky cubemap that is prefiltered
  bool tables = true;               ///< some pass uses the scattering tables
  bool curve = false;               ///< true: harmonics over the sun's elevation; false: for one sun
  std::uint64_t result_bytes = 0;   ///< memory of the results

  /// Returns the pass with a name. Throws `Error` (invalid_argument) if there is none.
  [[nodiscard]] const PlannedPass& pass(const std::string& name) const;
};

/// Plans a sky bake. Work for what the planet lacks is left out: the second scattering table without aerosol, the
/// shells of absorbers without absorbers, and sources of higher orders with one order. Throws `Error`
/// (invalid_argument) for what `check` or `precompute_sky` refuses.
[[nodiscard]] SkyPlan plan(const Atmosphere& atmosphere, const SceneNeeds& needs,
                           const SkyBakeOptions& full_options = {});

/// Result of a sky bake. Members that were not planned are empty.
struct SkyBake {
  std::shared_ptr<const SkyTables> tables;      ///< null if no pass needs them
  std::optional<SkyCurve> curve;                ///< for a moving sun
  std::optional<SphericalHarmonics> radiance;   ///< for a fixed sun, as from `SkyProjector`
  Sun sun;                                      ///< the sun as a directional light
  std::optional<PrefilteredSpecular> specular;  ///< for this sun; may be rotated about the vertical
  std::optional<Cubemap> background;            ///< the sky as a sharp cubemap
  std::shared_ptr<const BrdfTable> brdf;        ///< null if not planned
  std::vector<PassRecord> passes;  ///< in the plan's order; passes of tables repeat for more than three wavelengths
};

/// Bakes a sky for one sun according to a plan. Throws `Error`: invalid_argument, limit_exceeded.
[[nodiscard]] SkyBake bake(const SkyPlan& plan, const dvec3& sun, const Control& control = {});

/// Formats a table of passes: action, memory, reason, and times if `measured` has the bake's records.
[[nodiscard]] std::string plan_text(const SkyPlan& plan, const std::vector<PassRecord>& measured = {});

}  // namespace welkin
