// Where a cubemap's texels lie in a KTX2 or DDS file, whichever it is.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "files/row_source.h"
#include "files/supercompression.h"
#include "files/texel_formats.h"
#include "platform/file.h"

namespace welkin::files {

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
[[nodiscard]] TextureLayout read_ktx2_layout(platform::ByteFile& file);
[[nodiscard]] TextureLayout read_dds_layout(platform::ByteFile& file);

/// Of either, by the first bytes; unsupported_file if it is neither.
[[nodiscard]] TextureLayout read_texture_layout(platform::ByteFile& file);
[[nodiscard]] bool is_texture(platform::ByteFile& file);

/// Throws unsupported_file unless a header's sizes are those of a cubemap from 1 to 16384 texels, whole or not.
void check_cubemap_sizes(const platform::ByteFile& file, std::uint64_t width, std::uint64_t height,
                         std::uint64_t levels);

// Texels out of a KTX2 or DDS file.

/// Each thread has its own. Holds an unpacked level, if the file's are packed, until another is asked for.
class TextureReader {
 public:
  /// `layout` is that of the file, and outlives the reader. `stop` is looked at while a level is unpacked.
  TextureReader(const std::filesystem::path& path, const TextureLayout& layout, std::stop_token stop = {})
      : file_(path), layout_(layout), stop_(std::move(stop)) {}

  /// Rows of a face to `rows` x level size x 3 floats. Throws `Error`: corrupt_file, file_access, cancelled.
  void read(int level, int face, int first_row, int rows, float* rgb);

 private:
  void unpack_level(int level);

  platform::ByteFile file_;
  const TextureLayout& layout_;
  std::stop_token stop_;
  std::vector<std::uint8_t> texels_;
  int unpacked_level_ = -1;
};

/// The most that a reader holds while it reads so many rows of a level at once.
[[nodiscard]] std::uint64_t texture_reader_bytes(const TextureLayout& layout, int level, int rows) noexcept;

// KTX2 and DDS cubemaps as rows.

/// A file that `is_texture`. Its six faces are those of `CubemapView` and come as a vertical strip. Packed levels are
/// unpacked whole. 8-bit texels are linear or sRGB as the format says, or as ReadOptions.transfer has it. Throws as
/// `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_texture(platform::ByteFile& file, const ReadOptions& options);

// Whether a file's chain of levels is one of plain mips.

/// Whether a key of a file's metadata speaks of roughness ("welkin.roughness"): then the smaller levels are blurred for
/// reflections, and none of them stands for the picture.
[[nodiscard]] inline bool speaks_of_roughness(std::string key) {
  std::transform(key.begin(), key.end(), key.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return key.find("roughness") != std::string::npos;
}

}  // namespace welkin::files
