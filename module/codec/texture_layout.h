// Where a cubemap's texels lie in a KTX2 or DDS file, whichever it is.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "codec/byte_file.h"
#include "codec/texels.h"

namespace welkin::codec {

/// What a header says. Every place lies inside the file, and every level has the bytes that its size takes.
struct TextureLayout {
  struct Level {
    std::array<std::uint64_t, 6> faces{};  ///< first bytes, in the file; not of a supercompressed level
    std::uint64_t first_byte = 0;          ///< of a supercompressed level, whose six faces unpack together
    std::uint64_t packed_bytes = 0;
  };

  std::string container;  ///< "KTX2", "DDS"
  TexelKind kind = TexelKind::rgba16f;
  Supercompression supercompression = Supercompression::none;
  int size = 0;               ///< texels along an edge of level 0
  std::vector<Level> levels;  ///< largest first
  bool has_metadata = false;  ///< whether the container has a place for it
  std::map<std::string, std::string> metadata;

  [[nodiscard]] int level_size(int level) const noexcept { return size >> level > 1 ? size >> level : 1; }
};

/// "none", "zlib", "zstd"
[[nodiscard]] const char* name(Supercompression supercompression) noexcept;

/// Read a header and check it whole; no texel is read. The file stands at its beginning. Throw `Error`:
/// corrupt_file, unsupported_file, file_access.
[[nodiscard]] TextureLayout read_ktx2_layout(ByteFile& file);
[[nodiscard]] TextureLayout read_dds_layout(ByteFile& file);

/// Of either, by the first bytes; unsupported_file if it is neither.
[[nodiscard]] TextureLayout read_texture_layout(ByteFile& file);
[[nodiscard]] bool is_texture(ByteFile& file);

/// Throws unsupported_file unless a header's sizes are those of a cubemap from 1 to 16384 texels, whole or not.
void check_cubemap_sizes(const ByteFile& file, std::uint64_t width, std::uint64_t height, std::uint64_t levels);

}  // namespace welkin::codec
