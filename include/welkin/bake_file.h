// Bakes of files: whole, or planned with what a file already carries (mips, reflections, coefficients); requests about
// files for a worker; files of a sky's tables.
//
//   welkin::BakeResult light = welkin::bake_file("sky.exr", {}, {.specular = welkin::PrefilterOptions{.size = 512}});
//
//   const welkin::StoredEnvironment file = welkin::probe_environment("sky.env");
//   welkin::BakeResult needed = welkin::bake(file, welkin::plan(file, {.diffuse_bands = 3}));
//
//   auto job = worker.post(welkin::BakeFile{"sky.exr"});
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

// ---- What a file carries beside its pixels

/// What the levels below the first are.
enum class LevelContent {
  automatic,    ///< as the file says; DDS cannot: then they are not used
  radiance,     ///< plain mips
  reflections,  ///< prefiltered, a roughness each
};

/// What a file holds besides its pixels.
struct StoredEnvironment {
  FileInput input;       ///< what is read; bytes in memory must outlive this and its copies
  ReadOptions read;      ///< how it is to be read
  EnvironmentInfo info;  ///< what the file says of itself
  SourceShape shape;     ///< of the pixels as `read_environment` gives them

  bool compressed = true;       ///< pixels must be unpacked
  bool has_polynomial = false;  ///< of an .env: three bands of the light, in full where its pixels end at 255
  int levels = 1;               ///< of a cubemap
  LevelContent content = LevelContent::automatic;  ///< of those levels; automatic: it cannot be told
  std::vector<double> roughness;                   ///< of each level, where they are reflections

  /// "sky.env: Babylon.js .env, cubemap of 256, 9 prefiltered mips, polynomial"
  [[nodiscard]] std::string words() const;
};

/// Reads the header. `content` overrides what the file says; of reflections without a roughness each in the metadata
/// (`welkin.roughness`) it is spread as `RoughnessSchedule::linear` has it. Throws `Error` as `inspect_environment`.
[[nodiscard]] StoredEnvironment probe_environment(const FileInput& input, const ReadOptions& read = {},
                                                  LevelContent content = LevelContent::automatic);

// ---- Bakes of files

/// Reads and bakes a file: all that `read_environment` reads; the full size of .env, KTX2 and DDS cubemaps. Throws as
/// `read_environment` too.
[[nodiscard]] BakeResult bake_file(const FileInput& input, const ReadOptions& read_options = {},
                                   const BakeOptions& options = {}, const Control& control = {});

/// Plans a bake of a file that was probed, with what it carries. Where nothing wants pixels it is projected while it is
/// read, or not even read. Nothing is read here.
[[nodiscard]] Plan plan(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& whole = {});

/// Carries out the plan of a file. Throws as `bake` and `bake_file`, and invalid_argument for another file's plan.
[[nodiscard]] BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control = {});

// ---- Requests about files, for a worker (requests.h has the others)

// Each reads a file by its path, or from bytes that it shares (`memory`), which count against the worker's memory
// limit; the path is then their name.

/// `project_file`.
struct ProjectFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  ProjectionOptions options{};                             ///< how it is projected
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] Projection operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// `read_environment`.
struct ReadFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] Environment operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// `measure_environment`.
struct MeasureFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] EnvironmentStatistics operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// `bake_file`.
struct BakeFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  BakeOptions options{};                                   ///< what is made of it
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

// ---- Files of a sky's tables, so that they are computed once

/// Writes tables with all their parameters and a checksum; read again they are the same bits. Written beside, renamed.
/// Throws `Error`: invalid_argument for tables whose sizes are not their options', file_access.
void save_sky_tables(const SkyTables& tables, const FileOutput& output);
/// Reads tables that `save_sky_tables` wrote. Throws `Error`: file_access, corrupt_file (a checksum that differs, a
/// table cut off), unsupported_file (another version), limit_exceeded.
[[nodiscard]] SkyTables load_sky_tables(const FileInput& input,
                                        std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U);

// ---- Textures: cubemaps with their mips in KTX2, DDS and mip-mapped OpenEXR, and in Babylon.js's .env
//
//   welkin::write_texture("sky.ktx2", chain.views(), {.format = welkin::TexelFormat::rgba16f});
//   welkin::write_babylon_environment("sky.env", welkin::to_babylon(chain, light.radiance));

// -- KTX2, KTX, DDS and OpenEXR

/// How KTX2's levels are packed.
enum class Supercompression {
  none,  ///< as they are
  zlib,  ///< ZLIB
  zstd,  ///< Zstandard
};

/// How long is searched for a block's best numbers in ASTC. The names are astcenc's; docs/notes/textures.md has errors
/// and times.
enum class AstcEffort {
  fastest,   ///< some 1 Mtexel/s a thread (4 x 4, AMD EPYC Zen 4)
  fast,      ///< 0.7
  medium,    ///< 0.5
  thorough,  ///< 0.25
};

/// How texels are stored.
struct TextureOptions {
  TexelFormat format = TexelFormat::rgba16f;                   ///< OpenEXR holds rgba16f and rgba32f alone
  Supercompression supercompression = Supercompression::none;  ///< KTX2 only

  /// KTX2 and KTX: key/value data, 1 MiB at most, no key that starts with KTX. OpenEXR: string attributes, none that
  /// OpenEXR has already. DDS has no place for it and leaves it out.
  std::map<std::string, std::string> metadata{};

  Bc6hEffort bc6h_effort = Bc6hEffort::normal;  ///< with the BC6H formats, which KTX2, KTX and DDS hold
  AstcEffort astc_effort = AstcEffort::medium;  ///< with the ASTC formats, which KTX2 holds
};

/// Writes a cubemap with its mips, largest first, each half the one before (rounded down), in the format that the
/// extension names. Faces are those of `CubemapView`, which are the graphics APIs' own.
///
/// - .ktx2: Vulkan's formats of `TexelFormat`, linear Rec. 709; KTXorientation "rd".
/// - .ktx: the first version of KTX with OpenGL's formats, R11F_G11F_B10F the way Filament writes and reads it, its
/// type
///   being the internal format; nothing but the caller's key/value data.
/// - .dds: DX10 header, the same formats as DXGI has them.
/// - .exr: mip-mapped tiles, envmap attribute, in OpenEXR's own frames; half or float by `format`, ZIP; halves keep NaN
///   and infinities. OpenEXR's chain goes on to 1 x 1: levels that were not given are means of the last one, and the
///   attribute welkinLevels says how many were.
///
/// BC6H is for radiance; `encode_bc6h` gives its errors. ASTC is for radiance too, and is encoded
/// by the library astcenc, whose version decides what the bytes are (WELKIN_ASTC=OFF builds without it).
///
/// Memory: a block of rows; with BC6H and ASTC the whole chain in blocks, and with ASTC 3 MB a thread; in OpenEXR also
/// two levels that were not given; with supercompression the packed chain, and the levels that are being packed, side
/// by side. The same bytes on any number of threads (with the same zlib, Zstandard and astcenc). A file is complete or
/// not there. Throws `Error`: invalid_argument (an uneven chain, a format or option that the file cannot hold),
/// unsupported_file (the extension), file_access, cancelled.
WriteReport write_texture(const FileOutput& output, std::span<const CubemapView> mips,
                          const TextureOptions& options = {}, const Control& control = {});

/// Writes a two-dimensional texture of one level, as a BRDF table is, to .ktx2 or .dds: `rgb` is height x width x 3,
/// first row on top; 1 to 16384 each way. Throws as above.
WriteReport write_texture_2d(const FileOutput& output, int width, int height, const float* rgb,
                             const TextureOptions& options = {}, const Control& control = {});

/// Writes an octahedral map with all its levels to a two-dimensional .ktx2, whose metadata says the border
/// ("welkin.octahedral_border", texels of level 0). To .exr as plain pictures, halves, or floats with rgba32f; of more
/// than one level in a file each, "map_m0.exr", "map_m1.exr" and so on. Throws as above.
WriteReport write_octahedral(const FileOutput& output, const OctahedralMap& map, const TextureOptions& options = {},
                             const Control& control = {});

/// A texture that was read.
struct CubemapTexture {
  Cubemap cubemap;                              ///< all levels, as radiance
  std::string format;                           ///< "KTX2 rgba16f zstd", for a person
  std::map<std::string, std::string> metadata;  ///< KTX2's and KTX's key/value data
};

/// Reads .ktx2, .ktx and .dds cubemaps with all their mips, told by their first bytes: the four formats above, BC6H
/// (unsigned and signed), ASTC in blocks of 4 x 4 and 6 x 6 (KTX2), and r8g8b8a8 unorm and srgb; KTX2 also
/// supercompressed by ZLIB and Zstandard; DDS with a DX10 header. Alpha is passed over. The header is checked whole
/// before anything is allocated, and what would take more than the limit is refused. Throws `Error`: file_access,
/// corrupt_file, unsupported_file, limit_exceeded, cancelled.
[[nodiscard]] CubemapTexture read_texture(const FileInput& input,
                                          std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U,
                                          const Control& control = {});

// -- Babylon.js's .env: a prefiltered cubemap as RGBD pictures, with the polynomial that its shaders use

/// What an .env file holds, all of it in Babylon.js's axes, which are left-handed: x is Welkin's -x. Faces and rows are
/// in the order of `CubemapView`, row 0 on top (the file has them bottom row first).
struct BabylonEnvironment {
  int version = 2;                              ///< 1 or 2 when read; 2 is written
  Cubemap specular;                             ///< mip k for alpha = 2^(k / lod_generation_scale) / size, 0 at mip 0
  std::optional<BabylonPolynomial> polynomial;  ///< as stored: it is used, not computed again
  double lod_generation_scale = 0.8;            ///< Babylon.js stores 0 for what was not prefiltered
  Cubemap irradiance;  ///< irradiance / pi (1 in a uniform environment of 1); size 0: no irradiance texture
  std::optional<dvec3> dominant_direction;  ///< of the light; kept with an irradiance texture alone
};

/// An environment from Welkin's axes to Babylon.js's: faces mirrored texel by texel, and the polynomial of the turned
/// coefficients. What Babylon.js shows is then what it shows of the same picture by itself, neither turned nor
/// mirrored. `specular`: empty or a chain; `irradiance_over_pi`: of any size, 0 for none. Throws `Error`: never of its
/// own.
[[nodiscard]] BabylonEnvironment to_babylon(const Cubemap& specular, const SphericalHarmonics& radiance,
                                            const Cubemap& irradiance_over_pi = {});

/// The same cubemap mirrored in x: +X and -X change places, and columns run the other way. Both ways between
/// Welkin's axes and those of Babylon.js; no texel changes.
[[nodiscard]] Cubemap mirrored_x(const Cubemap& cubemap);

/// The faces of a chain as PNG pictures of RGBD, as .env files and EXT_lights_image_based of glTF have them.
struct RgbdPictures {
  std::vector<std::vector<std::uint8_t>> png;  ///< level x 6 + face, +X -X +Y -Y +Z -Z
  std::uint64_t values_clamped = 0;            ///< channel values below 0 or above 255, where RGBD ends (NaN becomes 0)
};

/// Packs them in parallel, as `write_babylon_environment` does: bottom row first, faces as they are in the chain (whose
/// axes the caller has turned). The same bytes on any number of threads. `control` gets progress. Throws `Error`:
/// unsupported_file in a build without libspng, cancelled.
[[nodiscard]] RgbdPictures rgbd_pictures(const Cubemap& chain, const Control& control = {});

/// Reads an .env file: versions 1 and 2 (older ones are read as 1), PNG and WebP pictures, told by their first bytes.
/// Faces in parallel; the same bits on any number of threads. The manifest may have 256 KiB; what the file's sizes take
/// above the memory limit is refused before a picture is read. Throws `Error`: file_access, corrupt_file,
/// unsupported_file, limit_exceeded, cancelled.
[[nodiscard]] BabylonEnvironment read_babylon_environment(const FileInput& input,
                                                          std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U,
                                                          const Control& control = {});

/// Writes version 2 with PNG pictures, packed in parallel: the same bytes on any number of threads. The chain's size
/// must be a power of two and the chain whole (down to 1 texel); a file is complete or not there. RGBD ends at 255 and
/// has no negatives: the report counts the values that were clamped, so the polynomial must come from the source and
/// not from mip 0. Throws `Error`: invalid_argument (also for an irradiance texture without a polynomial, and numbers
/// that are not finite), file_access, cancelled.
WriteReport write_babylon_environment(const FileOutput& output, const BabylonEnvironment& environment,
                                      const Control& control = {});

// ---- Probes: grids of them from files and to files
//
//   welkin::BakedProbes probes = welkin::bake_probe_files(grid, cubes, depths);
//   welkin::write_probes("level.json", probes, {{welkin::ProbeLayout::three}});

/// `bake_probes` of captures in files: .ktx2, .ktx or .dds cubemaps as `read_texture` takes them, of which level 0
/// counts. A depth is the first channel of a format of 32-bit floats (halves hold no more than three digits). The same
/// bits as of the pixels in memory, which are read as floats.
///
/// 128 probes are read and baked at a time, by all threads: that is all that is held of them. Throws `Error` as
/// `bake_probes` and `read_texture`; the message names the file.
[[nodiscard]] BakedProbes bake_probe_files(const ProbeGrid& grid, std::span<const FileInput> cubes,
                                           std::span<const FileInput> depths = {}, const ProbeOptions& options = {},
                                           const Control& control = {});

/// Writes probes as a description in JSON, with files beside it that the description names: NAME.bin with all arrays of
/// `BakedProbes` as they are (little-endian), and a three-dimensional KTX2 texture of halves for each texture of each
/// layout, NAME_LAYOUT.ktx2 or NAME_LAYOUT_TEXTURE.ktx2. docs/guides/probe_grids.md has the keys. All files are
/// complete or none is there. The same bytes on any number of threads. Throws `Error`: invalid_argument,
/// unsupported_file (a name that does not end in .json), file_access, cancelled.
WriteReport write_probes(const std::filesystem::path& path, const BakedProbes& probes,
                         std::span<const ProbeLayout> layouts = {}, const Control& control = {});

}  // namespace welkin
