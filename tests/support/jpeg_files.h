// JPEG files with gain maps, made on the spot with libjpeg's writer.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace welkin::test {

struct JpegRecipe {
  int width = 0;
  int height = 0;
  int components = 3;  ///< 1 or 3; 4 for CMYK
  bool progressive = false;
  std::vector<std::pair<int, std::string>> segments{};  ///< N of an application segment, APPn, and its bytes
};

/// A file's bytes, of quality 100 and whole colours: samples height x width x components come back within 2, and equal
/// ones as they are.
std::vector<char> jpeg_bytes(const JpegRecipe& recipe, const std::vector<std::uint8_t>& samples);

/// What libjpeg makes of it.
std::vector<std::uint8_t> jpeg_samples(const std::vector<char>& file);

/// Numbers of a gain map: of one channel, or of three.
struct GainNumbers {
  std::vector<double> minimum{0.0}, maximum{3.0}, gamma{1.0}, base_offset{1.0 / 64}, alternate_offset{1.0 / 64};
  bool base_is_hdr = false;
};

/// The XMP of a gain map's own JPEG, segment APP1: as attributes, or, of three channels, as lists.
std::string gain_xmp(const GainNumbers& numbers);

/// ISO 21496-1's segment APP2, with fractions of one denominator or of one each.
std::string gain_iso(const GainNumbers& numbers, bool common_denominator);

/// ICC's segment APP2: X, Y and Z of red, green and blue, adapted to D50, and nothing else.
std::string profile_segment(const std::array<std::array<double, 3>, 3>& colours);

/// Base image and gain map, one behind the other, with the XMP that Android writes in the first.
std::vector<char> gain_map_file(const std::vector<char>& base, const std::vector<char>& map);

/// Samples that differ: smooth, from 0 to 255.
std::vector<std::uint8_t> smooth_samples(int width, int height, int components);

}  // namespace welkin::test
