// The options of a bake, the needs of a scene on the command line and as JSON, and plans.
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
  std::filesystem::path folder;     ///< folder of `file` if it must not be a pipe; empty: it may be one
  std::optional<std::string> file;  ///< as named; read once, together with the option
  std::optional<SceneNeeds> needs_in_file;
  std::optional<RoughnessRange> glossy;
  bool no_glossy = false;
  bool no_background = false;
  bool no_diffuse = false;
  bool explain = false;
  bool plan_only = false;

  /// Returns whether any option describes the scene. Without one a bake makes everything that its options select.
  [[nodiscard]] bool any() const noexcept { return file || glossy || no_glossy || no_background || no_diffuse; }
  [[nodiscard]] bool explains() const noexcept { return explain || plan_only; }

  /// Returns the file's needs as changed by the flags; everything without either.
  [[nodiscard]] SceneNeeds needs() const;
};

/// Adds the options; they throw the errors of `read_needs`.
void add_needs_options(Options& table, NeedsChoice& choice);

/// Returns every member; "glossy" is {"minimum", "maximum"}, or null if there are no glossy materials.
[[nodiscard]] Json needs_json(SceneNeeds needs);
/// Reads needs; missing members are those of a default `SceneNeeds`. Throws `Error`: file_access, limit_exceeded (more
/// than a megabyte), corrupt_file naming the key for invalid JSON and for members of another name, kind or range.
[[nodiscard]] SceneNeeds read_needs(const std::filesystem::path& path, Pipes pipes);

[[nodiscard]] Json plan_json(const Plan& plan);

/// The given roughness of the mips: a schedule, or one number per mip.
struct RoughnessChoice {
  std::optional<RoughnessSchedule> schedule;
  std::vector<double> table;  ///< empty: use the schedule
};

/// Adds --roughness: the name of a schedule, or numbers separated by commas. `otherwise`: words for the default.
void add_roughness_option(Options& table, RoughnessChoice& choice, const std::string& otherwise);

/// Words for each `IrradianceMethod`, in their order.
inline constexpr std::array kIrradianceMethods{"automatic", "direct", "harmonics"};

struct BakeCommandOptions {
  CommonOptions common;
  std::optional<std::string> input;  ///< none: the image that `compute` makes
  bool sky = false;                  ///< `--sky`; the command needs either this or an input
  ComputeImage compute;              ///< none: the built-in sky
  std::string image_name;            ///< file in the folder for the computed image; empty: none
  std::string directory;
  std::string called;  ///< name of the input in files; they then depend neither on its file name nor on the time
  GivenOptions asked;  ///< the options that affect the result, for caches
  std::vector<std::string> also_read;  ///< files in addition to the input and those of `scene`
  std::set<Container> containers{Container::ktx2};
  bool containers_named = false;  ///< by --formats
  std::vector<OutputFile> files;  ///< to be written in addition to harmonics, previews, manifest; set by `settle_files`
  TextureOptions texture;
  bool format_named = false;  ///< by --ktx2-format
  bool previews = true;
  bool preview_page = false;             ///< write preview.html too
  int preview_size = 256;                ///< pixels across a sphere
  std::optional<double> exposure_stops;  ///< of the previews; none: by the environment

  PrefilterOptions specular;
  bool size_named = false;  ///< by --size
  bool all_mips = false;    ///< down to 1 texel
  bool brdf_named = false;  ///< by --brdf or --brdf-model
  RoughnessChoice roughness;
  std::optional<bool> fit_lookups;    ///< by --fit-lookups
  std::set<LobeFamily> lobes;         ///< additional chains
  Quality quality = Quality::normal;  ///< of reflections and irradiance, unless `rms_error` is there
  std::optional<double> rms_error;    ///< bound on reflections and irradiance
  int octahedral_size = 0;            ///< of the specular chain as an octahedral map; 0: none
  int background_size = 0;            ///< 0: the specular cubemap's
  int irradiance_size = 64;           ///< 0: no irradiance cubemap
  IrradianceMethod irradiance_method = IrradianceMethod::automatic;
  BakeOptions bake;  ///< all other members
  BrdfTableOptions brdf;
  bool no_brdf = false;

  NeedsChoice scene;
  ClampChoice clamp;
  OrientationOptions orientation;
  SunChoice sun;
};

/// Adds all options to the command. `options` must outlive it.
void add_bake_options(Options& table, BakeCommandOptions& options);

/// Adds the options that affect the result: --size, --mips, --irradiance, --brdf, --formats and so on; not --bands.
void add_result_options(Options& table, BakeCommandOptions& options);

/// Lists the files to write: those of the named formats; else the files that the engine loads, with the selected lobes;
/// else KTX2. Call it once all options are read.
void settle_files(BakeCommandOptions& options);

/// Returns whether the files are for an engine that determines them.
[[nodiscard]] bool is_engine_folder(const BakeCommandOptions& options) noexcept;

inline constexpr const char* kHarmonicsHeader = "sh.h";

/// Returns the name of the source file with the harmonics of sh.json: sh.h, or sh.cs in Unity's folder.
[[nodiscard]] const char* harmonics_name(const BakeCommandOptions& options) noexcept;

/// Returns whether the engine gets a lat-long from which it computes all light itself; the lat-long is then as large as
/// the source.
[[nodiscard]] bool is_lat_long_folder(const BakeCommandOptions& options) noexcept;

/// Returns whether a file holds the specular chain; if not, it is not baked.
[[nodiscard]] bool writes_reflections(const BakeCommandOptions& options) noexcept;

/// Returns remarks about options that the engine's folder ignores or that its shaders contradict.
[[nodiscard]] std::vector<std::string> option_notes(const BakeCommandOptions& options);

/// Returns the rotation of the cubemaps' faces to those of the engine; the identity if no cubemap is written. Throws
/// `Error` (invalid_argument) for cubemaps for an engine that has none.
[[nodiscard]] glm::dmat3 face_rotation(const BakeCommandOptions& options);

/// Returns the schedule's name, or the numbers separated by commas.
[[nodiscard]] std::string roughness_words(const BakeCommandOptions& options);

/// Returns the options as the library takes them: number of mips, roughness of each, memory. Throws `Error`
/// (invalid_argument) for contradictory options.
[[nodiscard]] BakeOptions library_options(const BakeCommandOptions& options);

/// Returns whether the reflections carry the harmonics in their key/value data, where Filament looks for them.
[[nodiscard]] bool stores_harmonics(const BakeCommandOptions& options);

}  // namespace welkin::tool
