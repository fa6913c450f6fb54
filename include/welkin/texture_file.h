// Cubemaps with their mips in files: KTX2, DDS and mip-mapped OpenEXR, which graphics APIs load as they are, and
// Babylon.js's .env.
//
//   welkin::write_texture("sky.ktx2", chain.views(), {.format = welkin::TexelFormat::rgba16f});
//   welkin::write_babylon_environment("sky.env", welkin::to_babylon(chain, light.radiance));
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "welkin/bc6h.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/octahedral.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- KTX2, KTX, DDS and OpenEXR

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
  CubemapChain cubemap;                         ///< all levels, as radiance
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

// ---- Babylon.js's .env: a prefiltered cubemap as RGBD pictures, with the polynomial that its shaders use

/// What an .env file holds, all of it in Babylon.js's axes, which are left-handed: x is Welkin's -x. Faces and rows are
/// in the order of `CubemapView`, row 0 on top (the file has them bottom row first).
struct BabylonEnvironment {
  int version = 2;                              ///< 1 or 2 when read; 2 is written
  CubemapChain specular;                        ///< mip k for alpha = 2^(k / lod_generation_scale) / size, 0 at mip 0
  std::optional<BabylonPolynomial> polynomial;  ///< as stored: it is used, not computed again
  double lod_generation_scale = 0.8;            ///< Babylon.js stores 0 for what was not prefiltered
  CubemapImage irradiance;  ///< irradiance / pi (1 in a uniform environment of 1); size 0: no irradiance texture
  std::optional<dvec3> dominant_direction;  ///< of the light; kept with an irradiance texture alone
};

/// An environment from Welkin's axes to Babylon.js's: faces mirrored texel by texel, and the polynomial of the turned
/// coefficients. What Babylon.js shows is then what it shows of the same picture by itself, neither turned nor
/// mirrored. `specular`: empty or a chain; `irradiance_over_pi`: of any size, 0 for none. Throws `Error`: never of its
/// own.
[[nodiscard]] BabylonEnvironment to_babylon(const CubemapChain& specular, const SphericalHarmonics& radiance,
                                            const CubemapImage& irradiance_over_pi = {});

/// The same cubemap mirrored in x: +X and -X change places, and columns run the other way. Both ways between
/// Welkin's axes and those of Babylon.js; no texel changes.
[[nodiscard]] CubemapChain mirrored_x(const CubemapChain& chain);
[[nodiscard]] CubemapImage mirrored_x(const CubemapImage& cubemap);

/// The faces of a chain as PNG pictures of RGBD, as .env files and EXT_lights_image_based of glTF have them.
struct RgbdPictures {
  std::vector<std::vector<std::uint8_t>> png;  ///< level x 6 + face, +X -X +Y -Y +Z -Z
  std::uint64_t values_clamped = 0;            ///< channel values below 0 or above 255, where RGBD ends (NaN becomes 0)
};

/// Packs them in parallel, as `write_babylon_environment` does: bottom row first, faces as they are in the chain (whose
/// axes the caller has turned). The same bytes on any number of threads. `control` gets progress. Throws `Error`:
/// unsupported_file in a build without libspng, cancelled.
[[nodiscard]] RgbdPictures rgbd_pictures(const CubemapChain& chain, const Control& control = {});

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

}  // namespace welkin
