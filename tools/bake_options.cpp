#include "tools/bake_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/engine_folders.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

constexpr int kLargestFace = 8192;
constexpr int kLargestIrradiance = 4096;
constexpr int kLargestTable = 4096;
constexpr int kMaxMips = 14;  // of the largest face
constexpr int kSmallestSphere = 8;
constexpr int kLargestSphere = 1024;
constexpr double kMaxStops = 60.0;

constexpr std::array<Container, 7> kContainers = {Container::ktx2, Container::dds, Container::exr, Container::hdr,
                                                  Container::pfm,  Container::env, Container::ktx};

Option size_option(const char* name, int& size, int minimum, int maximum, const std::string& text) {
  return {.names = name, .target = &size, .text = text, .type = "N", .bounds = whole_between(minimum, maximum)};
}

// Schedules by their names, and by those of engines that use them.
const std::vector<std::pair<std::string, RoughnessSchedule>>& schedule_words() {
  static const std::vector<std::pair<std::string, RoughnessSchedule>> words = {
      {"filament", RoughnessSchedule::filament}, {"three", RoughnessSchedule::filament},
      {"linear", RoughnessSchedule::linear},     {"gltf", RoughnessSchedule::linear},
      {"bevy", RoughnessSchedule::linear},       {"babylon", RoughnessSchedule::babylon},
      {"unity", RoughnessSchedule::unity},       {"unreal", RoughnessSchedule::unreal}};
  return words;
}

/// Returns the names of schedules, and of engines that use them, as --help lists words.
std::string schedule_names() {
  std::vector<std::string> names;
  for (const auto& [word, schedule] : schedule_words()) names.push_back(word);
  return alternatives(names);
}

/// Reads --roughness. Throws `BadValue`.
RoughnessChoice roughness_choice(const std::vector<std::string>& words) {
  RoughnessChoice choice;
  if (words.size() == 1) {
    for (const auto& [word, schedule] : schedule_words()) {
      if (!same_word(words.front(), word)) continue;
      choice.schedule = schedule;
      return choice;
    }
  }
  for (const std::string& word : words) {
    const std::optional<double> value = number_in(word);
    if (!value || !(*value >= 0.0 && *value <= 1.0)) {
      throw BadValue{"--roughness", word + " is neither " + schedule_names() +
                                        " nor a number from 0 to 1; pass one number per mip, such as 0,0.25,0.5,1"};
    }
    if (!choice.table.empty() && *value < choice.table.back()) {
      throw BadValue{"--roughness", "falls from " + significant(choice.table.back()) + " to " + significant(*value) +
                                        "; roughness must rise from mip to mip"};
    }
    choice.table.push_back(*value);
  }
  return choice;
}

std::optional<RoughnessSchedule> schedule_of_engine(const BakeCommandOptions& options) {
  const std::string engine = convention(options.orientation.to).name;
  for (const auto& [word, schedule] : schedule_words()) {
    if (word == engine) return schedule;
  }
  return std::nullopt;
}

/// Returns whether the engine's shaders look up mip 5 r for any number of mips.
bool looks_up_fifths(const BakeCommandOptions& options) noexcept {
  return options.orientation.to == Engine::playcanvas || options.orientation.to == Engine::qt;
}

std::vector<double> fifths(int mips) {
  std::vector<double> table(static_cast<std::size_t>(mips));
  for (std::size_t mip = 0; mip < table.size(); ++mip) table[mip] = std::min(1.0, static_cast<double>(mip) / 5.0);
  return table;
}

/// Returns the default schedule: that of the target engine, if it is known; of an .env alone Babylon.js's; else the
/// library's default.
RoughnessSchedule default_schedule(const BakeCommandOptions& options) {
  if (const auto schedule = schedule_of_engine(options)) return *schedule;
  return options.containers == std::set<Container>{Container::env} ? RoughnessSchedule::babylon
                                                                   : RoughnessSchedule::filament;
}

void choose_mips(const std::string& word, BakeCommandOptions& options) {
  options.all_mips = word == "all";
  if (options.all_mips) return;
  const std::optional<int> mips = whole_number_in(word);
  if (!mips || *mips < 1 || *mips > kMaxMips) {
    throw BadValue{"--mips", word + " is neither a number from 1 to " + std::to_string(kMaxMips) + " nor all"};
  }
  options.specular.mips = *mips;
}

void add_container_options(Options& table, BakeCommandOptions& options) {
  std::vector<std::string> words;
  words.reserve(kContainers.size());
  for (const Container container : kContainers) words.emplace_back(name(container));
  const auto store = [&options](const std::vector<std::string>& chosen) {
    options.containers.clear();
    for (const Container container : kContainers) {
      for (const std::string& word : chosen) {
        if (same_word(word, name(container))) options.containers.insert(container);
      }
    }
  };
  add_option(table, "--formats", On<std::vector<std::string>>(store), "LIST",
             "Formats of cubemaps: ktx2, dds, exr, hdr, pfm, env, ktx, separated by commas; default ktx2, or by --for: "
             "what that engine loads",
             {.words = words, .list = List::commas, .named = &options.containers_named});
  table.push_back(choice<TexelFormat>(
      "--ktx2-format", options.texture.format, texel_formats(),
      "The texel format of .ktx2 files, with 8 (default), 16, 4 or 4 bytes per texel; or blocks of "
      "BC6H, ASTC or UASTC HDR (for the web) with 1 byte per texel, or 4/9 (astc6x6). DDS and OpenEXR "
      "hold half floats, or "
      "floats with rgba32f; DDS also bc6h; KTX all but ASTC and UASTC HDR. Irradiance is never compressed"));
  table.back().named = &options.format_named;
  table.push_back(
      choice<Bc6hEffort>("--bc6h-effort", options.texture.bc6h_effort,
                         {{"fast", Bc6hEffort::fast}, {"normal", Bc6hEffort::normal}, {"slow", Bc6hEffort::slow}},
                         "Search effort of the BC6H and UASTC HDR encoders; default normal"));
  table.push_back(choice<AstcEffort>("--astc-effort", options.texture.astc_effort,
                                     {{"fastest", AstcEffort::fastest},
                                      {"fast", AstcEffort::fast},
                                      {"medium", AstcEffort::medium},
                                      {"thorough", AstcEffort::thorough}},
                                     "Search effort of the ASTC encoder; default medium"));
  table.push_back(choice<Supercompression>(
      "--supercompression", options.texture.supercompression,
      {{"none", Supercompression::none}, {"zlib", Supercompression::zlib}, {"zstd", Supercompression::zstd}},
      "Compression of .ktx2 files; default none"));
  add_option(table, "--no-previews", OnFlag([&options] { options.previews = false; }), "",
             "Write no previews, which take two thirds of the time up to 256 texels, less above");
  table.push_back(choice<bool>("--preview", options.preview_page, {{"png", false}, {"html", true}},
                               "Previews: PNG images, or html for preview.html next to them, a page whose spheres "
                               "and knot can be turned (3 MB); default png"));
  table.back().excludes = {"--no-previews"};
  table.push_back(size_option("--preview-size", options.preview_size, kSmallestSphere, kLargestSphere,
                              "Pixels across each sphere of preview_spheres.png, which is six spheres wide; default " +
                                  std::to_string(options.preview_size)));
  table.back().excludes = {"--no-previews"};
  add_option(table, "--exposure", &options.exposure_stops, "EV",
             "Exposure of the previews: radiance times 2^EV; default from the image: the 75th percentile of "
             "lit surroundings becomes 0.36, and the manifest states the value",
             {.bounds = number_between(-kMaxStops, kMaxStops), .excludes = {"--no-previews"}});
}

void add_specular_options(Options& table, BakeCommandOptions& options) {
  table.push_back(
      size_option("--size", options.specular.size, 1, kLargestFace,
                  "Texels per edge of the specular cubemap; default " + std::to_string(options.specular.size)));
  table.back().named = &options.size_named;
  table.push_back(size_option("--background-size", options.background_size, 0, kLargestFace,
                              "Texels per edge of the background cubemap; 0: as --size; default " +
                                  std::to_string(options.background_size) +
                                  ". A lat-long is four times as wide; in the folders of unity, unreal, blender, godot "
                                  "and usd it keeps the source's size unless this option is given"));
  add_option(table, "--mips", On<std::string>([&options](const std::string& word) { choose_mips(word, options); }),
             "N|all",
             std::string("Mips of the specular cubemap, 1 to 14, or all: down to 1 texel. Default: as many "
                         "as --roughness has numbers, else those of its schedule: filament and linear end at 4 "
                         "texels, unity has seven, babylon and unreal all"));
  add_roughness_option(table, options.roughness, "filament, or by --for");
  table.push_back(choice<std::optional<bool>>(
      "--fit-lookups", options.fit_lookups, {{"on", true}, {"off", false}},
      "Fits the lobes of mips to shaders that interpolate between mips by the formula of --roughness; materials look "
      "mips up as before. Default on with --for (except three) and for .env, else off"));
  table.push_back(choice<PrefilterMethod>(
      "--method", options.specular.method,
      by_name({PrefilterMethod::automatic, PrefilterMethod::spectral, PrefilterMethod::reference}),
      "How to prefilter: automatic (default: the fastest method within the error bounds), spectral, or reference (the "
      "integral, slow)"));
  table.push_back(choice<Quality>(
      "--quality", options.quality, by_name({Quality::fast, Quality::normal, Quality::reference}),
      "Accuracy of reflections and irradiance: fast (--rms-error 1e-2), normal (1e-3, the default), or reference (the "
      "integrals, which takes minutes). --rms-error overrides it"));
  add_option(table, "--rms-error", &options.rms_error, "ERROR",
             "Error bound of each mip and of the irradiance cubemap: root mean square error over root mean square, "
             "1e-6 to 1; default by --quality. The relative error of any texel is at most ten times that",
             {.bounds = number_between(1e-6, 1.0)});
}

/// Returns the minimum number of bands of radiance whose irradiance under a lone lamp, the worst of all images, has at
/// most this rms error, relative to the rms of that irradiance. With A_l of the cosine lobe (Ramamoorthi and Hanrahan
/// 2001, equation 8), the sum of (2 l + 1) A_l^2 over all degrees is 8 pi^2 / 3; no odd degree above 1 contributes, nor
/// does the last band.
int bands_within(double rms_error) {
  double rest = 8.0 / 3.0 * std::numbers::pi * std::numbers::pi;
  const double bound = rest * rms_error * rms_error;
  int bands = 0;
  do {
    rest -= (2 * bands + 1) * cosine_lobe(bands) * cosine_lobe(bands);
    ++bands;
  } while (rest > bound && bands + 1 < kMaximumBands);
  return bands;
}

void add_error_budget_option(Options& table, BakeCommandOptions& options) {
  const auto set = [&options](double budget) {
    options.rms_error = budget;
    options.bake.bands = bands_within(budget);
  };
  add_option(table, "--error-budget", On<double>(set), "ERROR",
             "Sets --rms-error, and as many --bands as irradiance needs for this error under a single lamp: 3 for "
             "0.09, 5 for 0.05, 15 for 0.01",
             {.bounds = number_between(1e-6, 1.0), .excludes = {"--quality", "--rms-error", "--bands"}});
}

/// Adds the options of results other than the specular cubemap.
void add_lobe_options(Options& table, BakeCommandOptions& options) {
  const auto store = [&options](const std::vector<std::string>& words) {
    options.lobes.clear();
    for (const LobeFamily lobe : {LobeFamily::charlie, LobeFamily::lambert, LobeFamily::phong}) {
      for (const std::string& word : words) {
        if (same_word(word, welkin::name(lobe))) options.lobes.insert(lobe);
      }
    }
  };
  add_option(table, "--lobe", On<std::vector<std::string>>(store), "LIST",
             "Additional cubemaps with other lobes than GGX, separated by commas: charlie "
             "(sheen, for glTF), lambert (irradiance over pi), phong (powers by --roughness)",
             {.words = {"ggx", "charlie", "lambert", "phong"}, .list = List::commas});
  table.push_back(size_option("--octahedral", options.octahedral_size, 0, 16384,
                              "Also writes the specular cubemap as an octahedral map for Godot's shaders, .ktx2 and "
                              ".exr: texels per edge including borders; default 0: none"));
}

void add_diffuse_options(Options& table, BakeCommandOptions& options) {
  table.push_back(size_option("--irradiance", options.irradiance_size, 0, kLargestIrradiance,
                              "Texels per edge of the irradiance cubemap; default 64; 0: none"));
  table.push_back(choice<IrradianceMethod>(
      "--irradiance-method", options.irradiance_method, by_order<IrradianceMethod>(kIrradianceMethods),
      "Method of the irradiance cubemap: within --rms-error of the integral (automatic, the "
      "default), the integral (direct, slow), or from --bands of harmonics, as in shaders"));
  add_option(table, "--no-brdf", &options.no_brdf, "", "Write no BRDF table");
  add_option(table, "--brdf", On<int>([&options](int size) { options.brdf.width = options.brdf.height = size; }), "N",
             "Texels per edge of the BRDF table; default 64",
             {.bounds = whole_between(1, kLargestTable), .excludes = {"--no-brdf"}, .named = &options.brdf_named});
  table.push_back(choice<BrdfModel>(
      "--brdf-model", options.brdf.model,
      {{"split-sum", BrdfModel::split_sum}, {"multiple-scattering", BrdfModel::multiple_scattering}},
      "Contents of the BRDF table: (scale, bias) of f0 (default), or Filament's DFG with multiple scattering"));
  table.back().excludes = {"--no-brdf"};
  table.back().named = &options.brdf_named;
}

bool is_by_fifths(const BakeCommandOptions& options) noexcept {
  return looks_up_fifths(options) && !options.roughness.schedule && options.roughness.table.empty();
}

/// Returns the selected schedule, else that of the target engine.
RoughnessSchedule schedule_of(const BakeCommandOptions& options) {
  return options.roughness.schedule.value_or(default_schedule(options));
}

std::vector<double> roughness_by_formula(const BakeCommandOptions& options, int mips, int size) {
  return is_by_fifths(options) ? fifths(mips) : mip_roughness(schedule_of(options), mips, size);
}

}  // namespace

std::string roughness_words(const BakeCommandOptions& options) {
  const std::vector<double>& table = options.roughness.table;
  if (table.empty()) return is_by_fifths(options) ? "fifths" : name(schedule_of(options));
  return listed(
      table, [](double value) { return significant(value); }, ",");
}

void add_roughness_option(Options& table, RoughnessChoice& choice, const std::string& otherwise) {
  const auto choose = [&choice](const std::vector<std::string>& words) { choice = roughness_choice(words); };
  add_option(table, "--roughness", On<std::vector<std::string>>(choose), schedule_names() + "|LIST",
             "Roughness of mips: an engine's schedule, or numbers separated by commas; default " + otherwise,
             {.list = List::commas});
}

void add_result_options(Options& table, BakeCommandOptions& options) {
  add_specular_options(table, options);
  add_lobe_options(table, options);
  in_group(table, "Reflections");
  add_diffuse_options(table, options);
  in_group(table, "Diffuse light and BRDF table");
  add_container_options(table, options);
  in_group(table, "Files and previews");
}

void add_bake_options(Options& table, BakeCommandOptions& options) {
  constexpr const char* kInput = "INPUT";
  add_input_options(table, options.input, options.sky);
  add_option(table, "-o,--output", &options.directory, "DIR",
             "The folder to write to, created if necessary; default the input's name without extension, or "
             "sky, which must be new, empty or from an earlier bake");
  add_json_option(table, options.common);
  in_group(table, "Input and output");
  add_result_options(table, options);
  table.push_back(size_option("--bands", options.bake.bands, 0, kMaximumBands,
                              "Bands of spherical harmonics; default 3; 0: none, and no files for them"));
  add_error_budget_option(table, options);
  in_group(table, "Diffuse light and BRDF table");
  add_needs_options(table, options.scene);
  in_group(table, "What the scene needs");
  add_orientation_options(table, options.orientation);
  option(table, "--for").text =
      "Write what this engine loads, and a README.md with the code; default welkin, for no engine; with --formats "
      "those "
      "formats in its axes. Faces, harmonics and lights are rotated so that the surroundings look the same there";
  add_pixel_options(table, options.bake.pixels, options.clamp);
  add_sun_options(table, options.sun, {"--gamma"});  // it is looked for in radiance, before pixels are decoded
  add_read_options(table, options.common, kInput);
  option(table, "--memory-limit").needs.clear();  // a bake of the built-in sky takes memory too
  add_threads_option(table, options.common);
  add_cache_option(table, options.common);
}

bool is_engine_folder(const BakeCommandOptions& options) noexcept {
  return !options.containers_named && has_folder(options.orientation.to);
}

bool is_lat_long_folder(const BakeCommandOptions& options) noexcept {
  return is_engine_folder(options) && contains(options.files, Content::lat_long) &&
         !contains(options.files, Content::background);
}

bool writes_reflections(const BakeCommandOptions& options) noexcept {
  return !is_lat_long_folder(options) || contains(options.files, Content::octahedral);
}

namespace {

/// Returns whether the roughness of the mips differs from the roughness that the engine's shaders look up. (.env and
/// .glb, for Babylon.js and glTF's viewers alone, always have their own.)
bool contradicts_engine(const BakeCommandOptions& options) {
  if (!is_engine_folder(options) || !contains(options.files, Content::specular)) return false;
  if (!options.roughness.schedule && options.roughness.table.empty()) return false;
  BakeCommandOptions by_engine = options;
  by_engine.roughness = {};
  const PrefilterOptions asked = *library_options(options).specular;
  const std::vector<double> by_formula = roughness_by_formula(by_engine, asked.mips.value(), asked.size);
  constexpr double kSame = 1e-3;
  return !std::ranges::equal(asked.roughness, by_formula, [](double a, double b) { return std::abs(a - b) <= kSame; });
}

/// Checks that an engine's folder holds only files that its README.md loads.
void check_textures_of_engine(const BakeCommandOptions& options) {
  const Engine engine = options.orientation.to;
  const std::string folder = std::string("--for ") + convention(engine).name;
  const std::vector<OutputFile> lat_longs = files_with(Content::lat_long, files_for(engine));
  const bool takes_floats = !lat_longs.empty() && lat_longs.front().container == Container::exr &&
                            options.texture.format == TexelFormat::rgba32f;
  const bool is_taken =
      takes_any_texture(engine) || takes_floats || options.octahedral_size > 0 || !options.lobes.empty();
  if (options.format_named && !is_taken) {
    throw Error(ErrorCode::invalid_argument,
                folder + " writes no file with a selectable texel format; leave --ktx2-format out, or pass --formats");
  }
  if (engine == Engine::three && options.texture.supercompression == Supercompression::zlib) {
    throw Error(ErrorCode::invalid_argument,
                folder + ": three.js's KTX2Loader does not read zlib; pass --supercompression zstd, or --formats");
  }
}

}  // namespace

std::vector<std::string> option_notes(const BakeCommandOptions& options) {
  std::vector<std::string> notes;
  if (!is_engine_folder(options)) return notes;
  const Convention& engine = convention(options.orientation.to);
  const std::string folder = std::string("--for ") + engine.name;
  if (options.brdf_named && !contains(options.files, Content::brdf)) {
    notes.push_back("--brdf and --brdf-model: " + folder +
                    " writes no BRDF table, because the engine has its own; pass --formats for your own shader");
  }
  const bool named = options.size_named || options.specular.mips || options.all_mips || options.roughness.schedule ||
                     !options.roughness.table.empty();
  if (named && !writes_reflections(options)) {
    notes.push_back(
        "--size, --mips and --roughness: " + folder +
        " writes no prefiltered cubemap, because the engine makes its own from the lat-long; --background-size N makes "
        "the lat-long 4 N texels wide");
  }
  const std::optional<RoughnessRange> glossy = options.scene.needs().glossy;
  if (glossy && glossy != RoughnessRange{} && writes_reflections(options)) {
    notes.push_back("--glossy: " + std::string(engine.title) +
                    " looks mips up by its own formula, so none is left out; pass --formats for your own shader");
  }
  if (contradicts_engine(options)) {
    notes.push_back(
        "--roughness: " + std::string(engine.title) +
        " looks mips up by its own formula, so materials show another roughness than theirs; leave it out, or look "
        "the mips up in your own shader");
  }
  return notes;
}

void settle_files(BakeCommandOptions& options) {
  if (!is_engine_folder(options)) {
    options.files = files_in(options.containers, options);
    return;
  }
  check_textures_of_engine(options);
  options.files = files_of_engine(options);
  for (const LobeFamily lobe : {LobeFamily::charlie, LobeFamily::lambert}) {
    if (contains(options.files, content_of(lobe))) options.lobes.insert(lobe);
  }
}

const char* harmonics_name(const BakeCommandOptions& options) noexcept {
  return is_engine_folder(options) && options.orientation.to == Engine::unity ? "sh.cs" : kHarmonicsHeader;
}

glm::dmat3 face_rotation(const BakeCommandOptions& options) {
  return contains_cubemap(options.files) ? faces_of(options.orientation.to) : glm::dmat3(1.0);
}

namespace {

/// Returns the default number of mips of the reflections: that of the schedule; for three.js, down to 8 texels.
int mips_wanted(const BakeCommandOptions& options) {
  const int size = options.specular.size;
  // PlayCanvas' atlas holds six. Qt's last mip is diffuse light, and reflections end at the one before.
  if (is_by_fifths(options)) return std::min(full_chain_levels(size), options.orientation.to == Engine::qt ? 7 : 6);
  const int mips = default_mip_count(schedule_of(options), size);
  // three.js's last mip is diffuse light too, which four texels would blur. Its own chain also ends at 8.
  constexpr int kMinMips = 5;
  const int to_eight = size >= 8 ? full_chain_levels(size / 8) : 1;
  return options.orientation.to == Engine::three ? std::min(mips, std::max(kMinMips, to_eight)) : mips;
}

/// Returns whether the lobes of mips are fitted to lookups between them: by default for engines that read their mips by
/// a known formula. Not for three.js, whose last mip is diffuse light too.
bool fits_lookups(const BakeCommandOptions& options) {
  if (!options.roughness.table.empty()) {
    if (!options.fit_lookups.value_or(false)) return false;
    throw Error(ErrorCode::invalid_argument,
                "--fit-lookups on needs a formula, and --roughness has numbers; pass a schedule, or leave it out");
  }
  if (is_by_fifths(options)) return false;  // not a formula of a schedule
  if (options.fit_lookups) return *options.fit_lookups;
  const RoughnessSchedule schedule = schedule_of(options);
  if (options.containers.contains(Container::env) && schedule == RoughnessSchedule::babylon) return true;
  return options.orientation.to != Engine::three && schedule_of_engine(options) == schedule;
}

/// Returns the options of a chain's octahedral map, with as many levels as have a whole number of texels per edge, at
/// least four. The border is one texel of the last level.
OctahedralOptions octahedral_of(int size, int chain_levels) {
  OctahedralOptions options{.size = size};
  while (options.levels < chain_levels && size % (2 << (options.levels - 1)) == 0 && (size >> options.levels) >= 4)
    ++options.levels;
  return options;
}

}  // namespace

BakeOptions library_options(const BakeCommandOptions& options) {
  BakeOptions bake = options.bake;
  PrefilterOptions specular = options.specular;
  const std::vector<double>& table = options.roughness.table;
  const RoughnessSchedule schedule = schedule_of(options);
  const auto numbers = static_cast<int>(table.size());
  if (options.all_mips) specular.mips = full_chain_levels(specular.size);
  if (numbers > 0 && specular.mips && *specular.mips != numbers) {
    throw Error(ErrorCode::invalid_argument, "--mips is " + std::to_string(*specular.mips) +
                                                 ", and --roughness has numbers for " + std::to_string(numbers) +
                                                 "; leave --mips out");
  }
  const int mips = specular.mips.value_or(numbers > 0 ? numbers : mips_wanted(options));
  if (mips > full_chain_levels(specular.size)) {
    throw Error(ErrorCode::invalid_argument,
                "a cubemap of " + std::to_string(specular.size) + " texels has at most " +
                    counted(static_cast<std::uint64_t>(full_chain_levels(specular.size)), "mip") + ", not " +
                    std::to_string(mips) + "; pass fewer --mips or a larger --size");
  }
  specular.mips = mips;
  const BakeOptions preset = BakeOptions::at(options.rms_error ? Quality::normal : options.quality);
  specular.rms_error = options.rms_error.value_or(preset.specular->rms_error);
  if (specular.method == PrefilterMethod::automatic) specular.method = preset.specular->method;
  specular.roughness = numbers > 0 ? table : roughness_by_formula(options, mips, specular.size);
  if (fits_lookups(options)) specular.lobe_roughness = fitted_mip_roughness(schedule, mips, specular.size);
  if (options.background_size > 0) bake.background->size = options.background_size;
  bake.irradiance.reset();
  // A cubemap that only previews would use is left out rather than refused for lack of harmonics.
  if (options.irradiance_size > 0 && (options.irradiance_method != IrradianceMethod::harmonics || bake.bands > 0 ||
                                      contains(options.files, Content::irradiance))) {
    bake.irradiance = IrradianceOptions{options.irradiance_size, options.irradiance_method,
                                        options.rms_error.value_or(preset.irradiance->rms_error)};
  }
  options.clamp.apply(bake.pixels);
  specular.pixels = bake.pixels;
  bake.specular = specular;
  if (options.octahedral_size > 0) bake.octahedral = octahedral_of(options.octahedral_size, mips);
  bake.brdf = options.no_brdf ? std::nullopt : std::optional(options.brdf);
  // The .env needs its polynomial, the .glb its coefficients, and Filament's reflections their harmonics; files of
  // harmonics depend on the selected bands.
  if (bake.bands == 0 && (contains_rgbd(options.files) || stores_harmonics(options))) bake.bands = 3;
  bake.memory_limit_bytes = options.common.read.memory_limit_bytes;
  return bake;
}

bool stores_harmonics(const BakeCommandOptions& options) {
  return options.orientation.to == Engine::filament && !files_with(Content::specular, options.files).empty() &&
         files_with(Content::specular, options.files).front().container == Container::ktx;
}

}  // namespace welkin::tool
