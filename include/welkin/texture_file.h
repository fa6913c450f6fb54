// Cubemaps with their mips as textures that graphics APIs load as they are: KTX2, DDS, and mip-mapped OpenEXR.
//
//   welkin::write_texture("sky.ktx2", chain.views(), {.format = welkin::TexelFormat::rgba16f});
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "welkin/control.h"
#include "welkin/cubemap_chain.h"
#include "welkin/environment_writer.h"
#include "welkin/export.h"
#include "welkin/image_view.h"
#include "welkin/upload.h"

namespace WELKIN_EXPORT welkin {

enum class Supercompression { none, zlib, zstd };  ///< of KTX2's levels

/// How texels are stored.
struct TextureOptions {
  TexelFormat format = TexelFormat::rgba16f;                   ///< OpenEXR holds rgba16f and rgba32f alone
  Supercompression supercompression = Supercompression::none;  ///< KTX2 only

  /// KTX2: key/value data, 1 MiB at most, no key that starts with KTX. OpenEXR: string attributes, none that OpenEXR
  /// has already. DDS has no place for it and leaves it out.
  std::map<std::string, std::string> metadata{};
};

/// Writes a cubemap with its mips, largest first, each half the one before (rounded down), in the format that the
/// extension names. Faces are those of `CubemapView`, which are the graphics APIs' own.
///
/// - .ktx2: Vulkan's formats of `TexelFormat`, linear Rec. 709; KTXorientation "rd".
/// - .dds: DX10 header, the same formats as DXGI has them.
/// - .exr: mip-mapped tiles, envmap attribute, in OpenEXR's own frames; half or float by `format`, ZIP; halves keep NaN
///   and infinities. OpenEXR's chain goes on to 1 x 1: levels that were not given are means of the last one, and the
///   attribute welkinLevels says how many were.
///
/// Memory: a block of rows; in OpenEXR also two levels that were not given; with supercompression the packed chain, and
/// the levels that are being packed, side by side. The same bytes on any number of threads (with the same zlib and
/// Zstandard). A file is complete or not there. Throws `Error`: invalid_argument (an uneven chain, a format or option
/// that the file cannot hold), unsupported_file (the extension), file_access, cancelled.
WriteReport write_texture(const std::filesystem::path& path, std::span<const CubemapView> mips,
                          const TextureOptions& options = {}, const Control& control = {});

/// Writes a two-dimensional texture of one level, as a BRDF table is, to .ktx2 or .dds: `rgb` is height x width x 3,
/// first row on top; 1 to 16384 each way. Throws as above.
WriteReport write_texture_2d(const std::filesystem::path& path, int width, int height, const float* rgb,
                             const TextureOptions& options = {}, const Control& control = {});

/// A texture that was read.
struct CubemapTexture {
  CubemapChain cubemap;                         ///< all levels, as radiance
  std::string format;                           ///< "KTX2 rgba16f zstd", for a person
  std::map<std::string, std::string> metadata;  ///< KTX2's key/value data
};

/// Reads .ktx2 and .dds cubemaps with all their mips, told by their first bytes: the four formats above, and r8g8b8a8
/// unorm and srgb; KTX2 also supercompressed by ZLIB and Zstandard; DDS with a DX10 header. Alpha is passed over. The
/// header is checked whole before anything is allocated, and what would take more than the limit is refused. Throws
/// `Error`: file_access, corrupt_file, unsupported_file, limit_exceeded, cancelled.
[[nodiscard]] CubemapTexture read_texture(const std::filesystem::path& path,
                                          std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U,
                                          const Control& control = {});

}  // namespace welkin
