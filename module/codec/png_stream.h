// A PNG file's bytes, without the chunks that nobody here wants.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "codec/byte_file.h"

namespace welkin::codec {

/// Hands out signature and chunks as they stand in the file, but passes over ancillary chunks other than gAMA, sRGB
/// and cHRM. Texts, profiles and previews can be megabytes, and a decoder that would keep them, or trip over a badly
/// made one, never sees them. A PNG's chunk is a length, a type, that many bytes, and a checksum.
/// (PNG specification, third edition, 5.3.)
class PngStream {
 public:
  explicit PngStream(const std::filesystem::path& path) : file_(path) {}

  /// The next `count` bytes. Throws as `ByteFile::read`.
  void read(void* bytes, std::size_t count);

  [[nodiscard]] const ByteFile& file() const noexcept { return file_; }

  // What was passed over so far and is worth a word.
  [[nodiscard]] bool has_profile() const noexcept { return has_profile_; }            ///< iCCP
  [[nodiscard]] bool has_transparency() const noexcept { return has_transparency_; }  ///< tRNS
  [[nodiscard]] bool has_code_points() const noexcept { return has_code_points_; }    ///< cICP

 private:
  void next_chunk();

  ByteFile file_;
  std::array<char, 8> start_{};  // signature, or a chunk's length and type
  std::size_t start_used_ = 8;   // of `start_`: bytes that were handed out
  std::uint64_t body_left_ = 0;  // bytes and checksum of the chunk that is handed out
  bool signature_is_out_ = false;
  bool has_profile_ = false, has_transparency_ = false, has_code_points_ = false;
};

}  // namespace welkin::codec
