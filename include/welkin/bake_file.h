// Files: bakes of files, bakes planned around what a file already contains, requests about files for a worker,
// textures, Babylon.js's .env, probe grids and sky tables.
//
//   welkin::BakeResult light = welkin::bake_file("sky.exr", {}, {.specular = welkin::PrefilterOptions{.size = 512}});
//
//   const welkin::StoredEnvironment file = welkin::inspect_stored_environment("sky.env");
//   welkin::BakeResult needed = welkin::bake(file, welkin::plan(file, {.diffuse_bands = 3}));
//
//   auto job = worker.post(welkin::BakeFile{"sky.exr"});
//
// Calls that read files throw `Error`: file_access, corrupt_file, unsupported_file, limit_exceeded. Calls that write
// files throw `Error`: invalid_argument for data that the format cannot hold, unsupported_file for the extension,
// file_access. Files are written atomically: complete or not at all. Their bytes are the same on any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- Contents of a file in addition to its pixels

/// Meaning of the levels below the first.
enum class LevelContent {
  automatic,    ///< as stated by the file; DDS cannot state it, and its levels are then not used
  radiance,     ///< plain mips
  reflections,  ///< prefiltered, one roughness per level
};

/// Header of a file, with what it contains in addition to its pixels.
struct StoredEnvironment {
  FileInput input;       ///< the file; bytes in memory must outlive this object and its copies
  ReadOptions read;      ///< options for reading it
  EnvironmentInfo info;  ///< its header
  SourceShape shape;     ///< shape of the pixels that `read_environment` returns

  bool compressed = true;       ///< pixels must be decompressed
  bool has_polynomial = false;  ///< .env only: three bands of light, which unlike the pixels are not clamped
  int levels = 1;               ///< levels of a cubemap
  LevelContent content = LevelContent::automatic;  ///< meaning of those levels; `automatic` if unknown
  std::vector<double> roughness;                   ///< roughness of each level, if they are reflections

  /// Returns a description such as "sky.env: Babylon.js .env, cubemap of 256, 9 prefiltered mips, polynomial".
  [[nodiscard]] std::string description() const;
};

/// Reads a header. `content` overrides what the file states. Reflections without roughness in their metadata
/// (`welkin.roughness`) are assumed to follow `RoughnessSchedule::linear`. Errors: those of `inspect_environment`.
[[nodiscard]] StoredEnvironment inspect_stored_environment(const FileInput& input, const ReadOptions& read = {},
                                                           LevelContent content = LevelContent::automatic);

// ---- Bakes of files

/// Reads and bakes a file of any kind that `read_environment` reads, by default the full size of files with mips.
/// Throws the same errors as `bake` and `read_environment`.
[[nodiscard]] BakeResult bake_file(const FileInput& input, const ReadOptions& read_options = {},
                                   const BakeOptions& options = {}, const Control& control = {});

/// Plans a bake of a probed file, using what it contains. If no pass needs pixels, the file is projected while it is
/// read, or not read at all. This call reads nothing.
[[nodiscard]] Plan plan(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& full_options = {});

/// Bakes a file according to its plan. Throws the same errors as `bake_file`, and `Error` (invalid_argument) for the
/// plan of another file.
[[nodiscard]] BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control = {});

// ---- Requests about files, for a worker (requests.h has the others)

// Each reads a file by its path, or from bytes that it shares (`memory`). Those count against the worker's memory
// limit, and the path is then their name in messages.

/// Request for `project_file`.
struct ProjectFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< options for reading
  ProjectionOptions options{};                             ///< options of the projection
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes; null to read the path

  [[nodiscard]] Projection operator()(const Control& control) const;
  /// Returns the size of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// Request for `read_environment`.
struct ReadFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< options for reading
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes; null to read the path

  [[nodiscard]] Environment operator()(const Control& control) const;
  /// Returns the size of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// Request for `measure_environment`.
struct MeasureFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< options for reading
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes; null to read the path

  [[nodiscard]] EnvironmentStatistics operator()(const Control& control) const;
  /// Returns the size of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// Request for `bake_file`. The result is returned by pointer.
struct BakeFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< options for reading
  BakeOptions options{};                                   ///< options of the bake
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes; null to read the path

  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  /// Returns the size of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

// ---- Files of sky tables

/// Writes sky tables with all their parameters and a checksum. Loading restores the same bits. Throws `Error`:
/// invalid_argument for tables whose sizes do not match their options, file_access.
void save_sky_tables(const SkyTables& tables, const FileOutput& output);
/// Reads tables written by `save_sky_tables`. Throws `Error`: file_access, corrupt_file (wrong checksum, truncated
/// table), unsupported_file (another version), limit_exceeded.
[[nodiscard]] SkyTables load_sky_tables(const FileInput& input,
                                        std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U);

// ---- Textures: cubemaps with their mips in KTX2, DDS and mip-mapped OpenEXR, and in Babylon.js's .env
//
//   welkin::write_texture("sky.ktx2", chain.views(), {.format = welkin::TexelFormat::rgba16f});
//   welkin::write_babylon_environment("sky.env", welkin::to_babylon(chain, light.radiance));

// -- KTX2, KTX, DDS and OpenEXR

/// Compression of KTX2's levels.
enum class Supercompression {
  none,  ///< uncompressed
  zlib,  ///< zlib
  zstd,  ///< Zstandard
};

/// Search effort of the ASTC encoder, by astcenc's names, with its speed for 4 x 4 blocks on one thread of an AMD EPYC
/// Zen 4. docs/notes/textures.md has errors and times.
enum class AstcEffort {
  fastest,   ///< 1 Mtexel/s
  fast,      ///< 0.7 Mtexel/s
  medium,    ///< 0.5 Mtexel/s
  thorough,  ///< 0.25 Mtexel/s
};

/// Options for writing textures.
struct TextureOptions {
  TexelFormat format = TexelFormat::rgba16f;                   ///< OpenEXR supports rgba16f and rgba32f
  Supercompression supercompression = Supercompression::none;  ///< KTX2 only

  /// KTX2 and KTX: key/value data, at most 1 MiB, without keys that start with KTX. OpenEXR: string attributes, without
  /// OpenEXR's own. DDS has no metadata; they are dropped.
  std::map<std::string, std::string> metadata{};

  Bc6hEffort bc6h_effort = Bc6hEffort::normal;  ///< for BC6H (KTX2, KTX, DDS) and UASTC HDR (KTX2)
  AstcEffort astc_effort = AstcEffort::medium;  ///< for the ASTC formats (KTX2)
};

/// Writes a cubemap with its mips, largest first, each half the size of the one before (rounded down), in the format
/// that the extension names. Faces have the axes of `CubemapView`, which are those of the graphics APIs.
///
/// - .ktx2: Vulkan's formats for `TexelFormat`, linear Rec. 709; KTXorientation "rd".
/// - .ktx: KTX 1 with OpenGL's formats, and the caller's metadata only. For R11F_G11F_B10F, glType is the internal
///   format, as in Filament.
/// - .dds: DX10 header, DXGI's formats.
/// - .exr: mip-mapped tiles with the envmap attribute, in OpenEXR's axes; half or float by `format`, ZIP; half floats
///   keep NaN and infinities. OpenEXR's chain extends to 1 x 1: missing levels are means of the last one, and the
///   attribute welkinLevels states how many were given.
///
/// BC6H and ASTC are for radiance. `bc6h_errors` measures the errors of BC6H. The bytes of ASTC files depend on
/// astcenc's version (WELKIN_ASTC=OFF builds without it), those of supercompressed files on zlib's and Zstandard's.
///
/// Memory: a block of rows; for BC6H and ASTC the encoded chain, for ASTC also 3 MB per thread; for OpenEXR also two of
/// the missing levels; with supercompression the compressed chain and the levels being compressed. Throws `Error`
/// (invalid_argument) also for mips of other sizes, and for options that the file cannot hold.
WriteReport write_texture(const FileOutput& output, std::span<const CubemapView> mips,
                          const TextureOptions& options = {}, const Control& control = {});

/// Writes a two-dimensional texture of one level, such as a BRDF table, to .ktx2 or .dds. `rgb` has height x width x 3
/// values, top row first; width and height are 1 to 16384.
WriteReport write_texture_2d(const FileOutput& output, int width, int height, const float* rgb,
                             const TextureOptions& options = {}, const Control& control = {});

/// Writes an octahedral map with all its levels. A .ktx2 is one two-dimensional texture, whose metadata states the
/// border ("welkin.octahedral_border", texels of level 0). An .exr is an image of half floats, or floats with rgba32f,
/// with one file per level if there are several: "map_m0.exr", "map_m1.exr", ...
WriteReport write_octahedral(const FileOutput& output, const OctahedralMap& map, const TextureOptions& options = {},
                             const Control& control = {});

/// A texture that was read.
struct CubemapTexture {
  Cubemap cubemap;                              ///< all levels, as radiance
  std::string format;                           ///< such as "KTX2 rgba16f zstd", for people
  std::map<std::string, std::string> metadata;  ///< key/value data of KTX2 and KTX
};

/// Reads .ktx2, .ktx and .dds cubemaps with all their mips, identified by their first bytes. Supported are the four
/// uncompressed formats of `TexelFormat`, BC6H (unsigned and signed), ASTC in blocks of 4 x 4 and 6 x 6 (KTX2), and
/// r8g8b8a8 unorm and srgb; KTX2 also with ZLIB and Zstandard supercompression; DDS with a DX10 header. Alpha is
/// ignored. The whole header is validated before memory is allocated.
[[nodiscard]] CubemapTexture read_texture(const FileInput& input,
                                          std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U,
                                          const Control& control = {});

// -- Babylon.js's .env: a prefiltered cubemap as RGBD images, with the polynomial that its shaders use

/// Contents of an .env file in Babylon.js's axes, which are left-handed: its x is Welkin's -x. Faces and rows are in
/// the order of `CubemapView`, top row first (the file stores the bottom row first).
struct BabylonEnvironment {
  int version = 2;                              ///< 1 or 2 when read; 2 is written
  Cubemap specular;                             ///< mip k for alpha = 2^(k / lod_generation_scale) / size, 0 at mip 0
  std::optional<BabylonPolynomial> polynomial;  ///< as stored
  double lod_generation_scale = 0.8;            ///< Babylon.js stores 0 for a chain that was not prefiltered
  Cubemap irradiance;  ///< irradiance / pi (1 in a uniform environment of 1); size 0: no irradiance texture
  std::optional<dvec3> dominant_direction;  ///< direction of the dominant light; stored only with an irradiance texture
};

/// Converts an environment from Welkin's axes to Babylon.js's: mirrors faces texel by texel, and computes the
/// polynomial of the rotated coefficients. Babylon.js then shows the environment as it shows the same image loaded
/// directly. `specular` is a chain or empty; `irradiance_over_pi` has any size, or 0 for none.
[[nodiscard]] BabylonEnvironment to_babylon(const Cubemap& specular, const SphericalHarmonics& radiance,
                                            const Cubemap& irradiance_over_pi = {});

/// Mirrors a cubemap in x: swaps +X and -X, and reverses columns. Texels are unchanged. Converts in both directions
/// between the axes of Welkin and Babylon.js.
[[nodiscard]] Cubemap mirrored_x(const Cubemap& cubemap);

/// Faces of a chain as PNG images in RGBD, for .env files and glTF's EXT_lights_image_based.
struct RgbdImages {
  std::vector<std::vector<std::uint8_t>> png;  ///< images by level x 6 + face, +X -X +Y -Y +Z -Z
  std::uint64_t values_clamped = 0;  ///< channel values below 0 or above 255, the range of RGBD (NaN becomes 0)
};

/// Encodes a chain as `write_babylon_environment` does: bottom row first, faces in the chain's axes (convert them
/// before). Throws `Error`: unsupported_file in a build without libspng.
[[nodiscard]] RgbdImages rgbd_images(const Cubemap& chain, const Control& control = {});

/// Reads an .env file: version 1 (or older) or 2, with PNG or WebP images, identified by their first bytes. The
/// manifest may have up to 256 KiB. The memory limit is checked before an image is decoded.
[[nodiscard]] BabylonEnvironment read_babylon_environment(const FileInput& input,
                                                          std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U,
                                                          const Control& control = {});

/// Writes an .env file of version 2 with PNG images. The chain's size must be a power of two, and its mips complete
/// down to 1 texel. RGBD clamps values to [0, 255], and the report counts them; compute the polynomial from the source,
/// not from mip 0. Throws `Error`: invalid_argument (also for an irradiance texture without a polynomial, and for
/// numbers that are not finite), file_access.
WriteReport write_babylon_environment(const FileOutput& output, const BabylonEnvironment& environment,
                                      const Control& control = {});

// ---- Probe grids from and to files
//
//   welkin::BakedProbes probes = welkin::bake_probe_files(grid, cubes, depths);
//   welkin::write_probes("level.json", probes, {{welkin::ProbeLayout::three}});

/// Bakes a probe grid from captures in files, as `bake_probes` does: level 0 of .ktx2, .ktx or .dds cubemaps that
/// `read_texture` reads. Depth is the first channel of a format with 32-bit floats (half floats have only three
/// digits).
///
/// 128 probes are read and baked at a time, on all threads, which bounds the memory. Throws the same errors as
/// `bake_probes` and `read_texture`; messages name the file.
[[nodiscard]] BakedProbes bake_probe_files(const ProbeGrid& grid, std::span<const FileInput> cubes,
                                           std::span<const FileInput> depths = {}, const ProbeOptions& options = {},
                                           const Control& control = {});

/// Writes probes as a JSON description and the files that it names: NAME.bin with all arrays of `BakedProbes`
/// (little-endian), and a KTX2 texture of half floats, three-dimensional or an array, per texture of each layout,
/// NAME_LAYOUT.ktx2 or NAME_LAYOUT_TEXTURE.ktx2; for `ProbeLayout::three` also NAME_three.json.
/// docs/guides/probe_grids.md lists the keys. All files are written, or none. The path must end in .json.
WriteReport write_probes(const std::filesystem::path& path, const BakedProbes& probes,
                         std::span<const ProbeLayout> layouts = {}, const Control& control = {});

/// Reads probes that `write_probes` wrote: a description, and the arrays from the file that it names in the same
/// folder, or from `arrays`, which a description in memory requires. All arrays keep their bits; the diagnostics are
/// empty. Throws `Error`: file_access, corrupt_file (the message names the key), unsupported_file (another format or
/// version), limit_exceeded (a description of more than a megabyte), invalid_argument (memory without `arrays`).
[[nodiscard]] BakedProbes read_probes(const FileInput& input, const std::optional<FileInput>& arrays = {});

}  // namespace welkin
