// Radiance images: the header in front of the pixels, and rows.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/primaries.h"
#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

/// Longer headers are refused; Radiance's have a few hundred bytes, a few thousand after many filters.
inline constexpr std::size_t kLongestHdrHeader = std::size_t{64} << 10U;

struct HdrHeader {
  bool xyz = false;         ///< 32-bit_rle_xyze: CIE XYZ instead of RGB
  glm::dvec3 divisor{1.0};  ///< the product of all EXPOSURE and COLORCORR lines; radiance = stored / divisor
  std::optional<Chromaticities> primaries;  ///< as the file states them
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

/// Reads a header. `file` is at its beginning and starts with "#?".
///
/// A header is lines of text: the magic word (RADIANCE, RGBE, or any other), NAME=value, comments, commands that
/// the image went through; an empty line; and the resolution line, such as "-Y 512 +X 1024". FORMAT, EXPOSURE,
/// COLORCORR and PRIMARIES are obeyed, everything else is ignored. Lines that start with white space belong
/// to the images that this one was made from (Radiance's pcompos indents them) and say nothing about it.
/// (Radiance's filefmts.pdf, and its header.c, `color.c`, resolu.c.)
/// Throws `Error`: corrupt_file, unsupported_file.
[[nodiscard]] HdrHeader read_hdr_header(platform::ByteFile& file);

// Radiance images (.hdr, .pic, .rgbe, .xyze) as rows.

/// Opens a Radiance file as rows. `file` is at its beginning and starts with "#?". See `read_hdr_header` for the lines
/// that are obeyed. XYZE and images with PRIMARIES become Rec. 709 unless requested as stored; one without PRIMARIES is
/// taken to be Rec. 709, as by all programs but Radiance itself.
///
/// Rows that are scanlines stream. Where columns are the scanlines, the first read decodes the whole image, which all
/// readers share: 4 bytes per texel. Throws the errors of `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_hdr(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
