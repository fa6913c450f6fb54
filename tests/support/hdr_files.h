// Radiance images of every form, written by code independent of the reader.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace welkin::test {

using Rgbe = std::array<std::uint8_t, 4>;

enum class HdrForm {
  flat,
  old_rle,
  new_rle,
  mixed,  ///< the three forms in turn, one per scanline
};

struct HdrRecipe {
  int width = 0;
  int height = 0;
  HdrForm form = HdrForm::new_rle;
  bool columns = false;       ///< X first in the resolution line
  bool bottom_first = false;  ///< +Y
  bool right_first = false;   ///< -X
  std::string magic = "#?RADIANCE";
  std::vector<std::string> lines = {"FORMAT=32-bit_rle_rgbe"};
};

/// Returns an image with long and short runs, black, and the largest and smallest exponents, but no texel that would
/// read as a repeat in the old form. Equal for equal arguments.
std::vector<Rgbe> some_rgbe(int width, int height, unsigned seed = 1);

/// Returns the decoded texels: mantissa * 2^(exponent - 136), and 0 for exponent 0. 3 floats each.
std::vector<float> decoded(const std::vector<Rgbe>& texels);

/// Returns the bytes of a file of the upright image `texels` (row 0 on top). Lengths that the new form cannot hold are
/// written flat.
std::vector<char> hdr_bytes(const HdrRecipe& recipe, const std::vector<Rgbe>& texels);

/// Returns the header, empty line and resolution line of a recipe.
std::string hdr_header(const HdrRecipe& recipe);

}  // namespace welkin::test
