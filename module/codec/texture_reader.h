// Texels out of a KTX2 or DDS file.
#pragma once

#include <cstdint>
#include <stop_token>
#include <utility>
#include <vector>

#include "codec/texture_layout.h"

namespace welkin::codec {

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

  ByteFile file_;
  const TextureLayout& layout_;
  std::stop_token stop_;
  std::vector<std::uint8_t> texels_;
  int unpacked_level_ = -1;
};

/// The most that a reader holds while it reads so many rows of a level at once.
[[nodiscard]] std::uint64_t texture_reader_bytes(const TextureLayout& layout, int level, int rows) noexcept;

}  // namespace welkin::codec
