// JPEG files with gain maps, written with libjpeg.
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
  std::vector<std::pair<int, std::string>> segments{};  ///< application segments: N of APPn, and the bytes
};

/// Returns a file's bytes, at quality 100 without chroma subsampling: samples height x width x components decode to
/// within 2, and equal ones exactly.
std::vector<char> jpeg_bytes(const JpegRecipe& recipe, const std::vector<std::uint8_t>& samples);

/// Returns the samples that libjpeg decodes.
std::vector<std::uint8_t> jpeg_samples(const std::vector<char>& file);

/// Numbers of a gain map of one channel or three.
struct GainNumbers {
  std::vector<double> minimum{0.0}, maximum{3.0}, gamma{1.0}, base_offset{1.0 / 64}, alternate_offset{1.0 / 64};
  bool base_is_hdr = false;
};

/// Returns the XMP of a gain map's JPEG, segment APP1: as attributes or, with three channels, as lists.
std::string gain_xmp(const GainNumbers& numbers);

/// Returns ISO 21496-1's segment APP2, with a common denominator for all fractions or one each.
std::string gain_iso(const GainNumbers& numbers, bool common_denominator);

/// Returns ICC's segment APP2, with only X, Y and Z of red, green and blue, adapted to D50.
std::string profile_segment(const std::array<std::array<double, 3>, 3>& colours);

/// Returns base image and gain map, one behind the other, with the XMP that Android writes in the first.
std::vector<char> gain_map_file(const std::vector<char>& base, const std::vector<char>& map);

/// Returns smooth samples that differ, from 0 to 255.
std::vector<std::uint8_t> smooth_samples(int width, int height, int components);

}  // namespace welkin::test
