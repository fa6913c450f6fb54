// The words in front of a Radiance image's pixels.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "files/primaries.h"
#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

/// Longer headers are refused; Radiance's own are some hundred bytes, a few thousand after many filters.
inline constexpr std::size_t kLongestHdrHeader = std::size_t{64} << 10U;

struct HdrHeader {
  bool xyz = false;         ///< 32-bit_rle_xyze: CIE XYZ instead of RGB
  glm::dvec3 divisor{1.0};  ///< the product of all EXPOSURE and COLORCORR lines; radiance = stored / divisor
  std::optional<Chromaticities> primaries;  ///< as the file has them
  std::string gamma;                        ///< of the last GAMMA line, if it is not 1
  int width = 0;                            ///< of the image when it is upright
  int height = 0;
  bool columns = false;       ///< scanlines are columns (X stands first in the resolution line)
  bool bottom_first = false;  ///< +Y
  bool right_first = false;   ///< -X
  std::uint64_t first_byte = 0;
  std::vector<std::string> notes;

  [[nodiscard]] int scanlines() const noexcept { return columns ? width : height; }
  [[nodiscard]] int scanline_length() const noexcept { return columns ? height : width; }
};

/// `file` stands at its beginning and starts with "#?".
///
/// A header is lines of text: the magic word (RADIANCE, RGBE, or any other), NAME=value, comments, commands that
/// the image went through; an empty line; and the resolution line, such as "-Y 512 +X 1024". FORMAT, EXPOSURE,
/// COLORCORR and PRIMARIES are obeyed, everything else is passed over. Lines that start with white space belong
/// to the images that this one was made from (Radiance's pcompos indents them) and say nothing about it.
/// (Radiance's filefmts.pdf, and its header.c, color.c, resolu.c.)
/// Throws `Error`: corrupt_file, unsupported_file.
[[nodiscard]] HdrHeader read_hdr_header(platform::ByteFile& file);

// The coded scanlines of a Radiance image, one after the other.

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
  HdrScanlines(const FileInput& input, int length, int count);

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

  platform::ByteFile file_;
  int length_;
  int count_;
  int scanline_ = 0;
  std::vector<std::uint8_t> buffer_;
  std::uint64_t buffer_position_ = 0;  // of the buffer's first byte in the file
  std::size_t cursor_ = 0;             // in the buffer
  std::size_t filled_ = 0;
};

// Where each scanline of a Radiance image starts.

/// The file has no such table, and where a scanline starts is known only from the codes of all before it. This finds
/// as many as are asked for, by passing over the codes, and remembers them: 8 bytes a scanline.
///
/// For any number of threads at once. One of them looks for new places; the others get those that are known without
/// waiting for it.
class HdrScanlineIndex {
 public:
  HdrScanlineIndex(const FileInput& input, int length, int count, std::uint64_t first_byte);

  /// Throws `Error` (corrupt_file, file_access) for the first scanline before `scanline` that cannot be passed over.
  [[nodiscard]] std::uint64_t position_of(int scanline);

  [[nodiscard]] static std::uint64_t memory_bytes(int count) noexcept;

 private:
  void scan_to(std::size_t scanline);
  [[nodiscard]] std::size_t known();

  int count_;
  std::mutex positions_mutex_;
  std::vector<std::uint64_t> positions_;  // guarded; of the scanlines from 0 on
  std::mutex scanner_mutex_;
  HdrScanlines scanner_;  // guarded; stands at the last known scanline
};

// A Radiance image whose scanlines are columns, held in memory as rows.

/// Every row has a texel of every column, so the whole image is decoded, once, when the first row is asked for.
/// For any number of threads at once.
class HdrColumns {
 public:
  HdrColumns(FileInput input, HdrHeader header);

  /// Row `row` of the upright image: four planes of `width` bytes. Throws as `HdrScanlines::decode`.
  [[nodiscard]] const std::uint8_t* row(int row);

  /// What all of it takes, in bytes: the image and what decoding needs.
  [[nodiscard]] static std::uint64_t memory_bytes(const HdrHeader& header) noexcept;

 private:
  void decode();

  FileInput input_;
  HdrHeader header_;
  std::mutex mutex_;
  std::unique_ptr<std::uint8_t[]> planes_;  // guarded until it is there
};

// From a Radiance image's bytes to RGB floats.

/// A component is mantissa * 2^(exponent - 136); with exponent 0, all three are 0. Radiance's own programs add
/// a half to the mantissa, to undo the mean of what truncation took away; every other reader and the writers that
/// round do not, and nor does this: a float holds each such value exactly.
class HdrTexels {
 public:
  /// Components are divided by `divisor` (what that leaves is rounded to double, then to float), then multiplied by
  /// `matrix` in double, if there is one.
  HdrTexels(const glm::dvec3& divisor, const std::optional<glm::dmat3>& matrix);

  /// `planes`: four of `length` bytes, mantissas and exponents. Texels go to `rgb` from the last to the first if
  /// `reversed`.
  void convert(const std::uint8_t* planes, int length, bool reversed, float* rgb) const noexcept;

 private:
  bool plain_;                                       // as they are stored
  std::array<std::array<double, 256>, 3> scales_{};  // of each component by exponent
  std::optional<glm::dmat3> matrix_;
};

// Radiance images (.hdr, .pic, .rgbe, .xyze) as rows.

/// `file` stands at its beginning and starts with "#?". See `read_hdr_header` for what of the header is obeyed,
/// `HdrScanlines` and `HdrTexels` for the codes and the numbers. XYZE and images with PRIMARIES become Rec. 709
/// unless they are wanted as stored; one without PRIMARIES is taken to be Rec. 709, as by all programs but Radiance
/// itself.
///
/// Rows that are scanlines stream. Where columns are the scanlines, the first read decodes the whole image, which
/// all readers share: 4 bytes a texel.
/// Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_hdr(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
