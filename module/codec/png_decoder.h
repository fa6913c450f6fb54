// libspng, one row after the other.
#pragma once

#include <spng.h>

#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>

#include "codec/png_stream.h"

namespace welkin::codec {

struct PngHeader {
  int width = 0;
  int height = 0;
  int bits = 8;  ///< of a sample in the file: 1, 2, 4, 8 or 16
  bool grey = false;
  bool palette = false;
  bool alpha = false;  ///< as a channel, or as the transparent colours of a tRNS chunk
  bool interlaced = false;
  bool says_srgb = false;        ///< has an sRGB chunk
  bool has_profile = false;      ///< has an iCCP chunk
  bool has_code_points = false;  ///< has a cICP chunk
  std::optional<double> gamma;   ///< of the gAMA chunk: the exponent from light to samples; 1 is linear
  std::optional<std::array<double, 8>> primaries;  ///< of the cHRM chunk: x and y of red, green, blue and white

  /// Of the rows that are handed out.
  [[nodiscard]] std::size_t texel_bytes() const noexcept { return bits == 16 ? 8 : 3; }
  [[nodiscard]] std::size_t row_bytes() const noexcept { return texel_bytes() * static_cast<std::size_t>(width); }
};

/// Rows come as RGB of 8 bits, or, from samples of 16 bits, as RGBA of 16 in the machine's byte order. Greys become
/// three equal samples, palettes their colours, and samples of fewer bits are spread to 0 .. 255, which is exact.
class PngDecoder {
 public:
  /// Reads up to the pixels. Throws `Error`: file_access, corrupt_file, unsupported_file.
  explicit PngDecoder(const std::filesystem::path& path);

  PngDecoder(const PngDecoder&) = delete;  // libspng knows where this is
  PngDecoder& operator=(const PngDecoder&) = delete;

  [[nodiscard]] const PngHeader& header() const noexcept { return header_; }

  /// The next row, from the top, to `header().row_bytes()` bytes. Not for an interlaced picture. With the last one
  /// the file is read to its end, so that its checksums are known to be right.
  /// Throws `Error`: corrupt_file, file_access.
  void decode_row(void* row);

  /// All rows at once, of any picture; called once, and instead of `decode_row`. Throws likewise.
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

}  // namespace welkin::codec
