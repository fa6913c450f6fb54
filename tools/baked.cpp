#include "tools/baked.h"

#include <algorithm>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <iostream>
#include <limits>
#include <utility>

#include "tools/chain_check.h"
#include "tools/engine_folders.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

/// The source of `welkin bake`: read, without its sun if that is extracted, rotated into Welkin's axes.
class BakeSource {
 public:
  /// Throws the errors of `read_environment`, and limit_exceeded if the source and its copies take too much memory.
  BakeSource(const BakeCommandOptions& options, const Control& control);

  [[nodiscard]] const Source& description() const noexcept { return description_; }
  /// The sun that was extracted or never in the pixels, in Welkin's axes.
  [[nodiscard]] const std::optional<Sun>& sun() const noexcept { return sun_; }
  [[nodiscard]] const std::optional<SkyReport>& sky() const noexcept { return sky_; }  ///< of a computed one
  /// Moves out the computed image, if it is to be kept.
  [[nodiscard]] LatLongImage take_image() noexcept { return std::move(image_); }
  /// The three bands that an .env stores in addition to its pixels, which end at 255, rotated as the pixels are. None
  /// if light was extracted, clamped or decoded: then the pixels alone count.
  [[nodiscard]] const std::optional<Projection>& stored_light() const noexcept { return stored_light_; }
  /// The harmonics of the pixels before those were rotated, rotated exactly; none if they were not.
  [[nodiscard]] const std::optional<SphericalHarmonics>& rotated_radiance() const noexcept { return radiance_; }
  /// Infinities that were replaced before the sun was extracted.
  [[nodiscard]] std::uint64_t infinities() const noexcept { return infinities_; }
  [[nodiscard]] std::uint64_t bytes() const;

  [[nodiscard]] EnvironmentView view() const { return pixels_.view(); }

 private:
  void read(const BakeCommandOptions& options, const Control& control);
  void orient(const BakeCommandOptions& options, const Control& control);

  Pixels pixels_;
  Source description_;
  std::optional<SkyReport> sky_;
  LatLongImage image_;
  std::optional<Sun> sun_;
  std::optional<Projection> stored_light_;
  std::optional<SphericalHarmonics> radiance_;
  std::uint64_t infinities_ = 0;
};

constexpr double kTurning = 0.7;  // fraction of the progress of reading where the rotation begins

bool is_reused(const Projection& projection) {
  const std::vector<PassRecord>& passes = projection.diagnostics.passes;
  return std::any_of(passes.begin(), passes.end(),
                     [](const PassRecord& pass) { return pass.name == "project" && pass.action == PassAction::reuse; });
}

/// Returns the light that an .env file stores in addition to its pixels; nothing without a polynomial, for a smaller
/// level, and where pixels are clamped or decoded, which the stored light does not reflect.
std::optional<Projection> light_stored_in(const EnvironmentInfo& info, const BakeCommandOptions& options,
                                          const Control& control) {
  const ReadOptions& read = options.common.read;
  if (info.format != FileFormat::babylon || read.level != 0) return std::nullopt;
  if (options.sun.take_out || options.clamp.clamps || options.bake.pixels.gamma) return std::nullopt;
  Projection projection = project_file(input_of(*options.input, read), read, {}, {control.stop, {}});
  if (!is_reused(projection)) return std::nullopt;
  return projection;
}

BakeSource::BakeSource(const BakeCommandOptions& options, const Control& control) {
  read(options, part_of(control, 0.0, kTurning));
  if (options.sun.take_out) {
    if (options.bake.pixels.infinity == NonFinitePolicy::replace) infinities_ = replace_infinities(pixels_);
    sun_ = extract_sun(pixels_, options.sun.options);
  }
  orient(options, part_of(control, kTurning, 1.0));
}

std::uint64_t BakeSource::bytes() const {
  return sizeof(float) * (3 * shape_of(view()).texels() + image_.pixels.size());
}

void BakeSource::read(const BakeCommandOptions& options, const Control& control) {
  if (!options.input) {
    ComputedImage computed = options.compute ? options.compute(control) : built_in_sky(control);
    if (!options.image_name.empty()) image_ = computed.image;
    pixels_.image = std::move(computed.image);
    description_ = std::move(computed.source);
    sky_ = std::move(computed.sky);
    sun_ = computed.sun;
    return;
  }
  Environment file = read_environment(input_of(*options.input, options.common.read), options.common.read, control);
  description_ = source_of(*options.input, file.info);
  stored_light_ = light_stored_in(file.info, options, control);
  pixels_.image = std::move(file);
}

void BakeSource::orient(const BakeCommandOptions& options, const Control& control) {
  OrientationOptions into_welkin = options.orientation;
  into_welkin.to = Engine::welkin;
  const bool is_cubemap = pixels_.is_cubemap();
  const glm::dmat3 rotation = light_rotation(into_welkin, is_cubemap);
  if (sun_) sun_->direction = rotation * sun_->direction;
  const glm::dmat3 matrix = image_rotation(into_welkin, is_cubemap, is_cubemap);
  if (matrix == glm::dmat3(1.0)) return;
  if (stored_light_) stored_light_->radiance = rotate(stored_light_->radiance, rotation);
  const std::uint64_t limit = options.common.read.memory_limit_bytes;
  if (2 * bytes() > limit) {
    throw Error(ErrorCode::limit_exceeded, description_.path + ": takes " + std::to_string(2 * bytes()) +
                                               " bytes while it is rotated, above the limit of " +
                                               std::to_string(limit) + "; raise " + options.common.memory_option);
  }
  const BakeOptions asked = library_options(options);
  if (asked.bands > 0) {
    const ProjectionOptions projection{.bands = asked.bands, .pixels = asked.pixels};
    radiance_ = rotate(project(view(), projection, {control.stop, {}}).radiance, rotation);
  }
  const SourceShape shape = shape_of(view());
  if (is_cubemap) {
    pixels_.image = to_cubemap(view(), shape.columns, matrix, ResampleFilter::area, control);
  } else {
    pixels_.image = to_lat_long(view(), shape.columns, shape.rows, matrix, ResampleFilter::area, control);
  }
}

/// Memory of steps of the work, in addition to the library's bake.
struct BakeMemory {
  std::string path{};             ///< of the source, for the message
  std::uint64_t source = 0;       ///< held until all is baked
  std::uint64_t second_bake = 0;  ///< of the .env's or .glb's chain: results and working memory; 0 if there is none
  int levels = 1;                 ///< of the source's file
  std::uint64_t lat_long = 0;     ///< of the lat-long that is written; 0 if there is none
};

/// The .env's or .glb's chain, in addition to the bake's own.
struct EnvChain {
  PrefilterOptions options;
  std::string pass;          ///< name of its bake
  bool wanted = false;       ///< such a file is selected, and materials would read it
  bool is_specular = false;  ///< the bake's own chain serves for it

  [[nodiscard]] bool second() const noexcept { return wanted && !is_specular; }
};

/// The plan of all that a folder needs.
struct FolderPlan {
  Plan light{};  ///< by the library's bake
  EnvChain env{};
  Plan whole{};  ///< with the additional chains
  BakeMemory memory{};
};

constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);

std::uint64_t cubemap_bytes(int size) {
  return 6 * kTexelBytes * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size);
}

std::uint64_t chain_bytes(int size, int levels) {
  std::uint64_t bytes = 0;
  for (int level = 0; level < levels; ++level) bytes += cubemap_bytes(std::max(1, size >> level));
  return bytes;
}

/// Returns 0 if there is none.
int background_size(const BakeOptions& bake) {
  if (!bake.background) return 0;
  return bake.background->size.value_or(bake.specular ? bake.specular->size : 0);
}

struct MemoryStep {
  std::uint64_t bytes;
  const char* what;
  const char* remedy;
};

constexpr const char* kSmallerSource = "reduce the image first ('welkin convert' with --size)";
constexpr const char* kSmallerLevel = "read a smaller one of its levels (--level)";
constexpr const char* kSmallerResults = "pass a smaller --size or --background-size";

/// Returns options by which `bake` makes the .env's or .glb's chain alone.
BakeOptions second_bake_options(const PrefilterOptions& env) {
  BakeOptions options;
  options.background.reset();
  options.specular = env;
  options.irradiance.reset();
  options.bands = 0;
  options.brdf = std::nullopt;
  options.pixels = env.pixels;
  return options;
}

/// Returns the step that takes the most memory: the bake itself, the .env's or .glb's chain, lat-longs, or rotating
/// cubemaps to the engine's faces. Excluded: previews, and the memory of encoders. `limit` affects the remedy.
MemoryStep largest_step(const FolderPlan& folder, const BakeCommandOptions& options, std::uint64_t limit) {
  const BakeMemory& memory = folder.memory;
  const BakeOptions& bake = folder.light.options;
  const int size = background_size(bake);
  const std::uint64_t background = chain_bytes(size, size > 0 ? full_chain_levels(size) : 0);
  const std::uint64_t specular = bake.specular ? chain_bytes(bake.specular->size, bake.specular->mips.value()) : 0;
  const std::uint64_t irradiance = bake.irradiance ? cubemap_bytes(bake.irradiance->size) : 0;
  const std::uint64_t results = background + specular + irradiance;
  const bool turns = face_rotation(options) != glm::dmat3(1.0);
  const PrefilterOptions& second = folder.env.options;
  const std::uint64_t env = memory.second_bake > 0 ? chain_bytes(second.size, second.mips.value()) : 0;

  const bool is_large = options.input && memory.source > results;
  const char* const smaller = !is_large ? kSmallerResults : memory.levels > 1 ? kSmallerLevel : kSmallerSource;
  MemoryStep worst{memory.source + folder.light.result_bytes + folder.light.working_bytes,
                   "source, results and working memory", smaller};
  const bool has_glb = contains(options.files, Content::gltf_light);
  const char* const without_env = worst.bytes > limit || !is_large ? smaller
                                  : has_glb                        ? "pass --formats, which writes no environment.glb"
                                                                   : "leave env out of --formats";
  const auto consider = [&worst](bool happens, const MemoryStep& step) {
    if (happens && step.bytes > worst.bytes) worst = step;
  };
  consider(memory.second_bake > 0,
           {memory.source + results + memory.second_bake,
            has_glb ? "source, results and the .glb's specular chain, which has its own roughness"
                    : "source, results and the .env's specular chain, which has its own roughness",
            without_env});
  consider(memory.second_bake > 0, {results + 2 * env,
                                    has_glb ? "results, the .glb's chain and its rotated faces"
                                            : "results, the .env's chain and its rotated faces",
                                    kSmallerResults});
  // If a pixel was replaced or clamped, the source is copied.
  consider(memory.lat_long > 0,
           {2 * memory.source + results + memory.lat_long, "source, results and the lat-long", smaller});
  consider(turns, {results + std::max(background, specular), "results and one of them rotated to the engine's faces",
                   kSmallerResults});
  return worst;
}

/// Throws `Error` (limit_exceeded) if a step would take more than the limit.
void check_memory(const FolderPlan& folder, const BakeCommandOptions& options) {
  const std::uint64_t limit = options.common.read.memory_limit_bytes;
  const MemoryStep worst = largest_step(folder, options, limit);
  if (worst.bytes <= limit) return;
  constexpr unsigned kMebi = 20;
  throw Error(ErrorCode::limit_exceeded,
              folder.memory.path + ": " + worst.what + " take " + std::to_string(worst.bytes) +
                  " bytes, above the limit of " + std::to_string(limit) + "; " + worst.remedy + ", or raise " +
                  options.common.memory_option + " to " + std::to_string((worst.bytes >> kMebi) + 1) + "MiB");
}

// Fractions of the progress.
constexpr double kRead = 0.15;
constexpr double kBaked = 0.75;

/// Returns the container of the file that Babylon.js reads as RGBD: its chain may differ from that of all other files.
const char* env_container(const BakeCommandOptions& options) {
  return name(contains(options.files, Content::gltf_light) ? Container::glb : Container::env);
}

std::string env_pass(const BakeCommandOptions& options) {
  return std::string("specular for .") + env_container(options);
}

/// Returns the options of that file's chain: Babylon.js computes the mip from the roughness by its own formula. The
/// chain of an .env goes down to one texel.
PrefilterOptions env_options(const PrefilterOptions& specular, const BakeCommandOptions& options) {
  PrefilterOptions env = specular;
  if (contains(options.files, Content::gltf_light)) {
    env.size = gltf_light_size(specular.size);
    env.mips = gltf_light_mips(env.size);
    env.roughness = gltf_light_roughness(env.size, *env.mips);
    env.lobe_roughness.clear();
    return env;
  }
  const int mips = full_chain_levels(specular.size);
  env.size = 1 << (mips - 1);  // the largest power of two that is not above it
  env.mips = mips;
  env.lobe_roughness.clear();
  env.use_schedule(RoughnessSchedule::babylon, options.fit_lookups.value_or(true));
  return env;
}

/// Replaces the results from the pixels of an .env, which end at 255, as `bake_file` does: up to three bands, and the
/// irradiance cubemap unless it was to be integrated directly.
void use_stored_light(Baked& baked, const Control& control) {
  const int bands = baked.options.bands;
  if (!baked.stored_light || bands == 0 || bands > baked.stored_light->radiance.bands()) return;
  BakeResult& light = baked.light;
  light.radiance = resized(baked.stored_light->radiance, bands);
  const ProjectionDiagnostics& stored = baked.stored_light->diagnostics;
  light.diagnostics.total_radiance = stored.total_radiance;
  light.diagnostics.total_radiance_before_clamp = stored.total_radiance_before_clamp;
  light.diagnostics.error_estimate = stored.error_estimate;
  const std::optional<IrradianceOptions>& irradiance = baked.options.irradiance;
  if (!irradiance || irradiance->method == IrradianceMethod::direct) return;
  light.irradiance_record.reset();
  light.irradiance =
      irradiance_cubemap(irradiance_from_radiance(*light.radiance), irradiance->size, {control.stop, {}});
}

/// Returns the needs with those of the files: the .env needs its polynomial, the .glb its coefficients. For an engine
/// that computes its light from a lat-long, only results in files are baked: the background is for the preview.
SceneNeeds needs_of(const BakeCommandOptions& options) {
  constexpr int kPolynomialBands = 3;
  SceneNeeds needs = options.scene.needs();
  if (!writes_reflections(options)) {
    needs.glossy.reset();
    needs.irradiance_cubemap = false;
  }
  if (is_lat_long_folder(options)) needs.background = options.previews;
  if (!needs.glossy) return needs;
  // An engine finds its mips by their number and its own formula, which a chain without some mips would not match.
  if (is_engine_folder(options)) needs.glossy = RoughnessRange{};
  if (!contains_rgbd(options.files)) return needs;
  // If its chain is the bake's own, leaving out mips of one would make the other an additional chain.
  const PrefilterOptions whole = *library_options(options).specular;
  if (env_options(whole, options) == whole) needs.glossy = RoughnessRange{};
  if (needs.diffuse_bands <= 1) needs.irradiance_cubemap = false;
  needs.diffuse_bands = std::max(needs.diffuse_bands, kPolynomialBands);
  return needs;
}

EnvChain env_chain(const BakeCommandOptions& options, const BakeOptions& whole, const Plan& planned) {
  const std::optional<PrefilterOptions>& specular = planned.options.specular;
  if (!contains_rgbd(options.files) || !specular) return {};  // a fit to lookups would take milliseconds
  EnvChain chain{env_options(*whole.specular, options), env_pass(options), true};
  chain.is_specular = chain.options == *specular;
  return chain;
}

/// States the reason for each pass that is skipped regardless of the scene.
void explain_folder(const BakeCommandOptions& options, Plan& planned) {
  if (!is_lat_long_folder(options)) return;
  for (PlannedPass& pass : planned.passes) {
    const bool is_light = pass.name == "specular" || pass.name == "brdf" || pass.name == "irradiance";
    const bool is_background = pass.name == "background" || pass.name == "background mips";
    if (pass.action != PassAction::skip || !(is_background || (is_light && !writes_reflections(options)))) continue;
    pass.reason = "no file of the folder holds it, because the engine makes its own from the lat-long";
  }
}

std::string lobe_pass(LobeFamily lobe) { return std::string("lobe ") + name(lobe); }

constexpr const char* kEnvReason = "Babylon.js has its own roughness for each mip";
constexpr const char* kLobeReason = "as --lobe asks";

/// Adds a chain that the library's bake does not make, and returns the bytes that it takes alone.
std::uint64_t plan_chain(const SourceShape& source, const PrefilterOptions& chain, const std::string& name,
                         const std::string& reason, Plan& planned) {
  const Plan alone = plan(source, SceneNeeds(), second_bake_options(chain));
  PlannedPass pass = alone.pass("specular");
  pass.name = name;
  pass.reason = reason + ": " + pass.reason;
  planned.result_bytes += alone.result_bytes;
  planned.working_bytes = std::max(planned.working_bytes, alone.working_bytes);
  planned.passes.push_back(std::move(pass));
  return alone.result_bytes + alone.working_bytes;
}

/// Returns whether a file's stored results may serve unchanged. (An .env becomes more than a plan describes.)
bool takes_stored(const BakeCommandOptions& options, const SceneNeeds& needs) {
  if (!options.input || !options.scene.any() || !needs.stored_results || options.sun.take_out) return false;
  if (contains_rgbd(options.files) || !options.lobes.empty()) return false;
  if (contains(options.files, Content::lat_long)) return false;  // made from the pixels
  OrientationOptions into_welkin = options.orientation;
  into_welkin.to = Engine::welkin;
  const glm::dmat3 identity(1.0);
  return image_rotation(into_welkin, true, true) == identity && image_rotation(into_welkin, false, false) == identity;
}

void explain(const BakeCommandOptions& options, const Plan& plan) {
  if (options.scene.explains()) std::cerr << plan_text(plan) << std::flush;
}

/// Bakes from the file with its stored results, by `baked.plan`.
void bake_stored(const StoredEnvironment& file, const BakeCommandOptions& options, Baked& baked,
                 const Control& control) {
  baked.source = source_of(*options.input, file.info);
  baked.options = baked.plan.options;
  explain(options, baked.plan);
  const std::uint64_t held = baked.plan.streams ? 0 : baked.plan.pass("read").bytes;
  check_memory({.light = baked.plan, .memory = {.path = baked.source.path, .source = held}}, options);
  with_cache(options.common, baked.notes, [&](ResultCache* cache) {
    baked.light = timed(baked.passes, kBakePass, "results that the scene needs", [&] {
      return cache != nullptr ? cache->bake(file, baked.plan, control) : bake(file, baked.plan, control);
    });
  });
}

BakeResult bake_light(const BakeSource& source, const Plan& plan, ResultCache* cache, const Control& control) {
  return cache != nullptr ? cache->bake(source.view(), plan, control) : bake(source.view(), plan, control);
}

PrefilteredSpecular prefilter_chain(const BakeSource& source, const PrefilterOptions& chain, ResultCache* cache,
                                    const Control& control) {
  return cache != nullptr ? cache->prefilter_specular(source.view(), chain, control)
                          : prefilter_specular(source.view(), chain, control);
}

/// Returns whether light stored in addition to the pixels may replace the light that is computed from them.
bool takes_light(const BakeCommandOptions& options, const SceneNeeds& needs) {
  return needs.stored_results || !options.scene.any();
}

StoredEnvironment header_of(const BakeCommandOptions& options) {
  return inspect_stored_environment(input_of(*options.input, options.common.read), options.common.read);
}

void note_dark_channels(const PrefilteredSpecular& chain, std::vector<std::string>& notes) {
  for (const PassRecord& pass : chain.pixels.passes) {
    if (pass.name.ends_with("dark channels")) notes.push_back("specular, " + pass.name + " " + pass.reason);
  }
}

/// Replaces the harmonics of pixels that resampling moved with exactly rotated ones.
void use_rotated_radiance(const BakeSource& source, Baked& baked) {
  constexpr double kRounding = 1e-5;  // for whole texels that only moved
  const std::optional<SphericalHarmonics>& whole = source.rotated_radiance();
  if (!whole || !baked.light.radiance || whole->bands() < baked.light.radiance->bands()) return;
  SphericalHarmonics exact = resized(*whole, baked.light.radiance->bands());
  const double difference = relative_difference(*baked.light.radiance, exact);
  if (!(difference > kRounding)) return;
  baked.light.radiance = std::move(exact);
  baked.notes.push_back("the image was rotated by resampling, by which its harmonics differ by " +
                        significant(100.0 * difference, 2) +
                        " %; harmonics are rotated exactly, cubemaps are made from the rotated image");
}

/// Notes that results are blurred if the chain has lost its sharpest mips, and with them a sharp environment.
void note_blur(const StoredEnvironment& file, const BakeCommandOptions& options, Baked& baked) {
  for (const std::string& note : file.info.notes) {
    if (std::ranges::find(baked.source.notes, note) == baked.source.notes.end()) baked.source.notes.push_back(note);
  }
  const auto level = static_cast<std::size_t>(std::max(0, options.common.read.level));
  if (level >= file.roughness.size() || file.roughness[level] <= 0.0) return;
  baked.notes.push_back("the input's pixels are prefiltered with roughness " + significant(file.roughness[level], 3) +
                        ", so all results are blurred by that");
}

/// Plans all parts of a folder. `memory`: the known sizes of the source.
FolderPlan plan_folder(const SourceShape& source, const BakeCommandOptions& options, const SceneNeeds& needs,
                       const BakeOptions& asked, BakeMemory memory) {
  FolderPlan folder{plan(source, needs, asked), {}, {}, std::move(memory)};
  explain_folder(options, folder.light);
  folder.env = env_chain(options, asked, folder.light);
  folder.whole = folder.light;
  const EnvChain& env = folder.env;
  if (env.second()) {
    folder.memory.second_bake = plan_chain(source, env.options, env.pass, kEnvReason, folder.whole);
  }
  for (const LobeFamily lobe : options.lobes) {
    plan_chain(source, lobe_options(lobe, options, *asked.specular), lobe_pass(lobe), kLobeReason, folder.whole);
  }
  folder.memory.lat_long = lat_long_bytes(source, options, asked);
  return folder;
}

/// Plans from a file's header the work on its pixels.
FolderPlan plan_header(const StoredEnvironment& file, const BakeCommandOptions& options, const SceneNeeds& needs,
                       const BakeOptions& asked) {
  return plan_folder(file.shape, options, needs, asked,
                     {.path = *options.input, .source = kTexelBytes * file.shape.texels(), .levels = file.levels});
}

/// Puts the plan into `baked`, and refuses work that would not fit into memory, as the library's own limit does.
FolderPlan plan_pixels(const BakeSource& source, const BakeCommandOptions& options, const SceneNeeds& needs,
                       Baked& baked) {
  FolderPlan folder = plan_folder(shape_of(source.view()), options, needs, baked.whole,
                                  {.path = baked.source.path, .source = source.bytes()});
  baked.plan = folder.whole;
  baked.options = folder.light.options;
  baked.env_container = env_container(options);
  baked.env_left_out = contains_rgbd(options.files) && !folder.env.wanted;
  baked.env_is_specular = folder.env.is_specular;
  explain(options, baked.plan);
  check_memory(folder, options);
  return folder;
}

/// Bakes from the pixels.
void bake_pixels(const BakeCommandOptions& options, const SceneNeeds& needs, Baked& baked, const Control& control) {
  std::optional<StoredEnvironment> file;
  if (options.input) {  // refuses by the header, before the pixels are read
    file = header_of(options);
    check_memory(plan_header(*file, options, needs, baked.whole), options);
  }
  BakeSource source =
      timed(baked.passes, "read", "the input", [&] { return BakeSource(options, part_of(control, 0.0, kRead)); });
  baked.source = source.description();
  baked.sky = source.sky();
  baked.sun = source.sun();
  baked.sun_wanted = options.sun.take_out || baked.sun.has_value();
  if (takes_light(options, needs)) baked.stored_light = source.stored_light();
  if (file) note_blur(*file, options, baked);
  const FolderPlan work = plan_pixels(source, options, needs, baked);
  const double end = work.env.second() ? kBaked : 1.0;
  const std::string reason = options.scene.any() ? "results that the scene needs" : "all requested results";
  with_cache(options.common, baked.notes, [&](ResultCache* cache) {
    baked.light = timed(baked.passes, kBakePass, reason,
                        [&] { return bake_light(source, work.light, cache, part_of(control, kRead, end)); });
    if (work.env.second()) {
      baked.env = timed(baked.passes, work.env.pass, kEnvReason, [&] {
        return prefilter_chain(source, work.env.options, cache, part_of(control, kBaked, 1.0));
      });
    }
    for (const LobeFamily lobe : options.lobes) {
      const PrefilterOptions chain = lobe_options(lobe, options, *baked.whole.specular);
      baked.lobes.push_back({lobe, timed(baked.passes, lobe_pass(lobe), kLobeReason, [&] {
                               return prefilter_chain(source, chain, cache, {control.stop, {}});
                             })});
    }
  });
  baked.light.diagnostics.infinities_replaced += source.infinities();
  use_rotated_radiance(source, baked);
  if (baked.light.specular) note_dark_channels(*baked.light.specular, baked.notes);
  if (baked.stored_light) {
    timed(baked.passes, "stored light", "diffuse light as stored in the input, not clamped as its pixels are",
          [&] { use_stored_light(baked, control); });
  }
  if (contains(options.files, Content::lat_long)) {
    baked.lat_long = timed(baked.passes, "lat-long", "from the source's pixels", [&] {
      return lat_long_of(source.view(), options, baked.whole, {control.stop, {}});
    });
  }
  baked.image = source.take_image();
  if (work.env.wanted) baked.env_mips = baked.env ? baked.env->mips : baked.light.specular->mips;
}

}  // namespace

Plan plan_ahead(const BakeCommandOptions& options, const Control& control) {
  const SceneNeeds needs = needs_of(options);
  const BakeOptions asked = library_options(options);
  if (!options.input) {
    const BakeSource source(options, part_of(control, 0.0, kRead));
    return plan_folder(shape_of(source.view()), options, needs, asked, {}).whole;
  }
  const StoredEnvironment file = header_of(options);
  return takes_stored(options, needs) ? plan(file, needs, asked) : plan_header(file, options, needs, asked).whole;
}

Prediction predict(const BakeCommandOptions& options) {
  constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
  const StoredEnvironment file = header_of(options);
  const FolderPlan header = plan_header(file, options, needs_of(options), library_options(options));
  const MemoryStep largest = largest_step(header, options, kNoLimit);
  return {file.info, file.shape.texels(), header.whole.result_bytes, largest.bytes};
}

Baked bake_source(const BakeCommandOptions& options, const Control& control) {
  Baked baked;
  baked.whole = library_options(options);
  const SceneNeeds needs = needs_of(options);
  if (takes_stored(options, needs)) {
    const StoredEnvironment file = header_of(options);
    baked.plan = plan(file, needs, baked.whole);
    bake_stored(file, options, baked, control);
  } else {
    bake_pixels(options, needs, baked, control);
  }
  return baked;
}

}  // namespace welkin::tool
