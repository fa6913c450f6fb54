// PNG files of every kind, written with libspng.
#pragma once

#include <spng.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace welkin::test {

struct PngRecipe {
  int width = 0;
  int height = 0;
  int bits = 8;
  int colour_type = SPNG_COLOR_TYPE_TRUECOLOR;
  bool interlaced = false;
  std::vector<spng_plte_entry> palette{};
  std::optional<std::uint32_t> gamma{};  ///< times 100000
  bool srgb = false;
  std::optional<spng_chrm_int> primaries{};
};

/// Returns the number of samples per texel.
int png_channels(const PngRecipe& recipe);

/// Returns random samples within the recipe's depth and palette: height x width x channels.
std::vector<std::uint16_t> some_samples(const PngRecipe& recipe, unsigned seed = 1);

/// Returns a file's bytes.
std::vector<char> png_bytes(const PngRecipe& recipe, const std::vector<std::uint16_t>& samples);

/// Returns CRC-32 as in the PNG specification, annex D.
std::uint32_t png_checksum(const char* bytes, std::size_t count);

/// Returns the file with a chunk inserted after its header. Its checksum is wrong: for chunks that a reader must not
/// examine, and for damage.
std::vector<char> with_png_chunk(std::vector<char> file, const std::string& type, const std::string& data);

/// Returns the file with another size in its header and the header's checksum corrected.
std::vector<char> with_png_size(std::vector<char> file, std::uint32_t width, std::uint32_t height);

}  // namespace welkin::test
