// JPEG files that hold a base image and, after it, the JPEG of its gain map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "files/primaries.h"
#include "platform/file.h"
#include "welkin/environment_file.h"

namespace welkin::files {

// Gain maps, which turn a JPEG's ordinary image into an HDR image.

/// The mapping from the samples of a gain map to changes of the base image, per channel. (ISO 21496-1:2025, 5.2;
/// Android's Ultra HDR image format 1.1, whose XMP has the same numbers.)
///
///   gain = minimum + (maximum - minimum) sample^(1 / gamma)
///   result = (base + base_offset) 2^gain - alternate_offset
///
/// with samples from 0 to 1 and linear colours, of which 1 is the white of ordinary images.
struct GainMap {
  bool by_iso = false;                         ///< otherwise by XMP
  bool from_base = true;                       ///< the base is the ordinary image
  std::array<double, 3> minimum{}, maximum{};  ///< base-2 logarithms
  std::array<double, 3> gamma{1.0, 1.0, 1.0};
  std::array<double, 3> base_offset{1.0 / 64, 1.0 / 64, 1.0 / 64};
  std::array<double, 3> alternate_offset{1.0 / 64, 1.0 / 64, 1.0 / 64};
};

// The file's images.

/// The contents of one JPEG image's markers. (ITU-T T.81, annex B.)
struct JpegSegments {
  std::uint64_t begin = 0;  ///< offset of its first byte in the file
  std::uint64_t end = 0;    ///< offset after its last byte
  int width = 0;
  int height = 0;
  int bits = 0;
  int components = 0;
  bool buffered = false;                    ///< must be decoded whole: progressive, or in several scans
  std::optional<GainMap> gain_map;          ///< if this image is one
  std::optional<Chromaticities> primaries;  ///< of its ICC profile, if they are not sRGB's
  bool has_other_profile = false;           ///< an ICC profile that names no primaries
};

/// Returns a file's images in order: at most 16, up to the first gain map. They are searched for in the file: the
/// offsets that an MPF segment or XMP states are wrong once a tool has added a segment. Throws `Error` (corrupt_file,
/// file_access), and unsupported_file for anything but a JPEG of 8 bits with 1 or 3 components.
[[nodiscard]] std::vector<JpegSegments> jpeg_images(platform::ByteFile& file);

/// Decodes rows of one image by libjpeg, from the top: grey, or RGB by JFIF's matrix, 8 bits per sample. Bits do not
/// depend on the machine: it uses the slow integer transform, and libjpeg's interpolation of colours.
class JpegDecoder {
 public:
  /// Throws `Error`: corrupt_file, file_access.
  JpegDecoder(const FileInput& input, const JpegSegments& image);
  ~JpegDecoder();

  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  [[nodiscard]] std::size_t row_bytes() const noexcept;

  /// Decodes the next row to `row_bytes()` bytes. The last one reads the image to its end. Throws `Error`:
  /// corrupt_file, file_access.
  void decode_row(std::uint8_t* row);

  /// Returns an upper bound on the memory of one decoder.
  [[nodiscard]] static std::uint64_t memory_bytes(const JpegSegments& image) noexcept;

 private:
  struct State;  // libjpeg's, whose header defines common words as macros
  std::unique_ptr<State> state_;
};

}  // namespace welkin::files
