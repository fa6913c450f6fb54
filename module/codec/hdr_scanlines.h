// The coded scanlines of a Radiance picture, one after the other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "codec/byte_file.h"

namespace welkin::codec {

/// How a scanline is held. Each scanline of a file says for itself; `flat` is the old form without a repeat.
enum class HdrCoding { flat, old_rle, new_rle };

/// Reads through scanlines with a handle and a buffer of its own. Not for two threads at once.
///
/// A scanline is either four runs of bytes, one a component, after the bytes 2, 2 and its length (the "new" form,
/// of lengths from 8 to 32767), or texels of four bytes each, among which (1, 1, 1, n) says "the last texel, n times
/// more", and the next such one right after it "256 n times more", and so on (the "old" form). A new-looking start
/// whose length has its highest bit set is an old texel. (Radiance's color.c: freadcolrs, oldreadcolrs.)
///
/// What Radiance reads without a word, or past the end of its memory, is refused: repeats that leave the scanline,
/// and a repeat before any texel.
class HdrScanlines {
 public:
  /// Of a file with `count` scanlines of `length` texels.
  HdrScanlines(const std::filesystem::path& path, int length, int count);

  /// Makes `scanline`, whose code starts at `position` in the file, the next one.
  void seek(int scanline, std::uint64_t position);

  [[nodiscard]] int scanline() const noexcept { return scanline_; }

  /// Where the next scanline starts.
  [[nodiscard]] std::uint64_t position() const noexcept { return buffer_position_ + cursor_; }

  /// Decodes the next scanline to four planes of `length` bytes: the components' mantissas and the exponents.
  /// Throws `Error`: corrupt_file naming scanline and byte, file_access.
  HdrCoding decode(std::uint8_t* planes) { return pass(planes); }

  /// Passes over it. Throws just as `decode` would.
  HdrCoding skip() { return pass(nullptr); }

  /// What one object holds, in bytes.
  [[nodiscard]] static std::uint64_t memory_bytes() noexcept;

 private:
  HdrCoding pass(std::uint8_t* planes);
  void pass_component(std::uint8_t* plane);
  HdrCoding pass_texels(std::uint8_t* planes);
  const std::uint8_t* take(std::size_t count);
  const std::uint8_t* peek(std::size_t count);
  [[noreturn]] void fail(const std::string& what) const;

  ByteFile file_;
  int length_;
  int count_;
  int scanline_ = 0;
  std::vector<std::uint8_t> buffer_;
  std::uint64_t buffer_position_ = 0;  // of the buffer's first byte in the file
  std::size_t cursor_ = 0;             // in the buffer
  std::size_t filled_ = 0;
};

}  // namespace welkin::codec
