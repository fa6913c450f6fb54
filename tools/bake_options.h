// What a scene needs: on the command line and as JSON; and plans.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/arguments.h"
#include "tools/input.h"
#include "tools/json.h"
#include "tools/output_files.h"
#include "tools/sky_model.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::tool {

struct NeedsChoice {
  std::filesystem::path folder;     ///< in which `file` is, if that is no pipe; empty: it may be one
  std::optional<std::string> file;  ///< as it was named; it is read once, when the option is
  std::optional<SceneNeeds> needs_in_file;
  std::optional<RoughnessRange> glossy;
  bool no_glossy = false;
  bool no_background = false;
  bool no_diffuse = false;
  bool explain = false;
  bool plan_only = false;

  /// Whether anything was said of the scene. Without it a bake does all that its options ask for.
  [[nodiscard]] bool any() const noexcept { return file || glossy || no_glossy || no_background || no_diffuse; }
  [[nodiscard]] bool explains() const noexcept { return explain || plan_only; }

  /// The file's, and what flags say on top; everything where nothing was said.
  [[nodiscard]] SceneNeeds needs() const;
};

/// The options throw as `read_needs`.
void add_needs_options(Options& table, NeedsChoice& choice);

/// Every member; "glossy" is {"minimum", "maximum"}, or null where there are no glossy materials.
[[nodiscard]] Json needs_json(SceneNeeds needs);
/// What is missing is as in a default `SceneNeeds`. Throws `Error`: file_access, limit_exceeded (more than a megabyte),
/// corrupt_file naming the key, for what is no JSON and for members of another name, kind or range.
[[nodiscard]] SceneNeeds read_needs(const std::filesystem::path& path, Pipes pipes);

[[nodiscard]] Json plan_json(const Plan& plan);

/// How roughness is spread over the mips, where that was said: a schedule, or a number a mip.
struct RoughnessChoice {
  std::optional<RoughnessSchedule> schedule;
  std::vector<double> table;  ///< empty: the schedule's
};

/// --roughness: the name of a schedule, or numbers with commas between them. `otherwise`: words for the default.
void add_roughness_option(Options& table, RoughnessChoice& choice, const std::string& otherwise);

/// Words for each `IrradianceMethod`, in their order.
inline constexpr std::array kIrradianceMethods{"automatic", "direct", "harmonics"};

struct BakeCommandOptions {
  CommonOptions common;
  std::optional<std::string> input;  ///< none: what `compute` makes
  bool sky = false;                  ///< `--sky`; the command wants either this or an input
  ComputeImage compute;              ///< none: the built-in sky
  std::string image_name;            ///< the file in the folder that keeps what was computed; empty: none does
  std::string directory;
  std::string called;  ///< what files call the input; then they do not depend on its name, nor on the time
  GivenOptions asked;  ///< what says what comes out, for caches
  std::vector<std::string> also_read;  ///< files beside the input and those of `scene`
  std::set<Container> containers{Container::ktx2};
  bool containers_named = false;  ///< by --formats
  std::vector<OutputFile> files;  ///< that are written, beside harmonics, previews and manifest: `settle_files`
  TextureOptions texture;
  bool format_named = false;  ///< by --ktx2-format
  bool previews = true;
  bool preview_page = false;             ///< and preview.html
  int preview_size = 256;                ///< pixels across a sphere
  std::optional<double> exposure_stops;  ///< of the previews; none: by the environment

  PrefilterOptions specular;
  bool size_named = false;  ///< by --size
  bool all_mips = false;    ///< down to 1 texel
  bool brdf_named = false;  ///< by --brdf or --brdf-model
  RoughnessChoice roughness;
  std::optional<bool> fit_lookups;    ///< by --fit-lookups
  std::set<LobeFamily> lobes;         ///< of which there are chains, too
  Quality quality = Quality::normal;  ///< of reflections and irradiance, unless `rms_error` is there
  std::optional<double> rms_error;    ///< bound on reflections and irradiance
  int octahedral_size = 0;            ///< of the specular chain as an octahedral map; 0: none
  int background_size = 0;            ///< 0: the specular cubemap's
  int irradiance_size = 64;           ///< 0: no irradiance cubemap
  IrradianceMethod irradiance_method = IrradianceMethod::automatic;
  BakeOptions bake;  ///< what is not said above
  BrdfTableOptions brdf;
  bool no_brdf = false;

  NeedsChoice scene;
  ClampChoice clamp;
  OrientationOptions orientation;
  SunChoice sun;
};

/// Adds all options to the command. `options` must outlive it.
void add_bake_options(Options& table, BakeCommandOptions& options);

/// Those that say what comes out: --size, --mips, --irradiance, --brdf, --formats and so on; not --bands.
void add_result_options(Options& table, BakeCommandOptions& options);

/// Lists the files that the options ask for: those of the formats that are named; else what the engine loads that the
/// files are for, with the lobes that it takes; else KTX2. To be called once all options are read.
void settle_files(BakeCommandOptions& options);

/// Whether they are for an engine that says which files there are.
[[nodiscard]] bool is_engine_folder(const BakeCommandOptions& options) noexcept;

inline constexpr const char* kHarmonicsHeader = "sh.h";

/// The file beside sh.json that a compiler reads: sh.h, or sh.cs in Unity's folder.
[[nodiscard]] const char* harmonics_name(const BakeCommandOptions& options) noexcept;

/// Returns whether the engine gets a lat-long from which it computes all light itself; it is then as large as the
/// source.
[[nodiscard]] bool is_lat_long_folder(const BakeCommandOptions& options) noexcept;

/// Returns whether a file holds the specular chain; if not, it is not baked.
[[nodiscard]] bool writes_reflections(const BakeCommandOptions& options) noexcept;

/// Returns remarks about options that the engine's folder ignores or that its shaders contradict.
[[nodiscard]] std::vector<std::string> option_notes(const BakeCommandOptions& options);

/// The turn of the cubemaps' faces to those of the engine; the identity where no cubemap is written. Throws `Error`
/// (invalid_argument) for cubemaps for an engine that has none.
[[nodiscard]] glm::dmat3 face_rotation(const BakeCommandOptions& options);

/// The schedule's name, or the numbers with commas between them.
[[nodiscard]] std::string roughness_words(const BakeCommandOptions& options);

/// The options as the library takes them: number of mips, roughness of each, memory. Throws `Error` (invalid_argument)
/// for those that contradict each other.
[[nodiscard]] BakeOptions library_options(const BakeCommandOptions& options);

/// Whether the reflections carry the harmonics in their key/value data, where Filament looks for them.
[[nodiscard]] bool stores_harmonics(const BakeCommandOptions& options);

}  // namespace welkin::tool
