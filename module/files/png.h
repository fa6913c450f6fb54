// A PNG file's bytes, without the chunks that nobody here wants.
#pragma once

#include <spng.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <glm/mat3x3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "files/primaries.h"
#include "files/row_source.h"
#include "platform/file.h"
#include "welkin/environment_file.h"

namespace welkin::files {

/// Hands out signature and chunks as they stand in the file, but passes over ancillary chunks other than gAMA, sRGB
/// and cHRM. Texts, profiles and previews can be megabytes, and a decoder that would keep them, or trip over a badly
/// made one, never sees them. A PNG's chunk is a length, a type, that many bytes, and a checksum.
/// (PNG specification, third edition, 5.3.)
class PngStream {
 public:
  explicit PngStream(const FileInput& input) : file_(open_file(input)) {}

  /// The next `count` bytes. Throws as `ByteFile::read`.
  void read(void* bytes, std::size_t count);

  [[nodiscard]] const platform::ByteFile& file() const noexcept { return file_; }

  // What was passed over so far and is worth a word.
  [[nodiscard]] bool has_profile() const noexcept { return has_profile_; }            ///< iCCP
  [[nodiscard]] bool has_transparency() const noexcept { return has_transparency_; }  ///< tRNS
  [[nodiscard]] bool has_code_points() const noexcept { return has_code_points_; }    ///< cICP

 private:
  void next_chunk();

  platform::ByteFile file_;
  std::array<char, 8> start_{};  // signature, or a chunk's length and type
  std::size_t start_used_ = 8;   // of `start_`: bytes that were handed out
  std::uint64_t body_left_ = 0;  // bytes and checksum of the chunk that is handed out
  bool signature_is_out_ = false;
  bool has_profile_ = false, has_transparency_ = false, has_code_points_ = false;
};

// libspng, one row after the other.

struct PngHeader {
  int width = 0;
  int height = 0;
  int bits = 8;  ///< of a sample in the file: 1, 2, 4, 8 or 16
  bool grey = false;
  bool palette = false;
  bool alpha = false;  ///< as a channel, or as the transparent colours of a tRNS chunk
  bool interlaced = false;
  bool says_srgb = false;                   ///< has an sRGB chunk
  bool has_profile = false;                 ///< has an iCCP chunk
  bool has_code_points = false;             ///< has a cICP chunk
  std::optional<double> gamma;              ///< of the gAMA chunk: the exponent from light to samples; 1 is linear
  std::optional<Chromaticities> primaries;  ///< of the cHRM chunk

  /// Of the rows that are handed out.
  [[nodiscard]] std::size_t texel_bytes() const noexcept { return bits == 16 ? 8 : 3; }
  [[nodiscard]] std::size_t row_bytes() const noexcept { return texel_bytes() * static_cast<std::size_t>(width); }
};

/// Rows come as RGB of 8 bits, or, from samples of 16 bits, as RGBA of 16 in the machine's byte order. Greys become
/// three equal samples, palettes their colours, and samples of fewer bits are spread to 0 .. 255, which is exact.
class PngDecoder {
 public:
  /// Reads up to the pixels. Throws `Error`: file_access, corrupt_file, unsupported_file.
  explicit PngDecoder(const FileInput& input);

  PngDecoder(const PngDecoder&) = delete;  // libspng knows where this is
  PngDecoder& operator=(const PngDecoder&) = delete;

  [[nodiscard]] const PngHeader& header() const noexcept { return header_; }

  /// The next row, from the top, to `header().row_bytes()` bytes. Not for an interlaced image. With the last one
  /// the file is read to its end, so that its checksums are known to be right.
  /// Throws `Error`: corrupt_file, file_access.
  void decode_row(void* row);

  /// All rows at once, of any image; called once, and instead of `decode_row`. Throws likewise.
  void decode_all(void* rows);

 private:
  struct Free {
    void operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }
  };
  static int read_stream(spng_ctx* context, void* decoder, void* bytes, std::size_t count) noexcept;
  void read_header();
  void check(int result);
  [[nodiscard]] int format() const noexcept { return header_.bits == 16 ? SPNG_FMT_RGBA16 : SPNG_FMT_RGB8; }

  PngStream stream_;
  std::exception_ptr stream_failure_;
  std::unique_ptr<spng_ctx, Free> context_;
  PngHeader header_;
  int next_row_ = 0;
};

// From a PNG's samples to RGB floats.

/// A sample of n bits is sample / (2^n - 1), through sRGB's curve or not, rounded once to float: a table of 256 or
/// 65536, made here and the same everywhere.
class PngSamples {
 public:
  /// `sixteen_bits`: RGBA of 16 bits in the machine's byte order; else RGB of 8. `transfer` is srgb or linear. Texels
  /// are multiplied by `matrix` in double, if there is one.
  PngSamples(bool sixteen_bits, Transfer transfer, const std::optional<glm::dmat3>& matrix);

  /// `coded`: `count` texels, of 3 or 8 bytes, at any address.
  void convert(const std::uint8_t* coded, std::size_t count, float* rgb) const noexcept;

  [[nodiscard]] std::uint64_t memory_bytes() const noexcept { return table_.size() * sizeof(float); }

 private:
  bool sixteen_bits_;
  std::vector<float> table_;
  std::optional<glm::dmat3> matrix_;
};

/// Writes RGB of 8 bits in sRGB, row by row without gaps, as a PNG: some six times as fast as `write_png`, to files a
/// tenth larger. For images that are looked at once. Throws `Error` (file_access) and unsupported_file without
/// libspng.
void write_png_quickly(platform::WholeFile& file, const std::vector<std::uint8_t>& rgb, int width);

}  // namespace welkin::files
