// Radiance images of every form, made on the spot by code that knows nothing of the reader.
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
  mixed,  ///< each scanline in another of the three
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

/// An image with long and short runs, darkness, and the largest and smallest exponents; no texel that would read as
/// a repeat in the old form. The same for the same arguments.
std::vector<Rgbe> some_rgbe(int width, int height, unsigned seed = 1);

/// What the texels mean: mantissa * 2^(exponent - 136), and 0 for exponent 0. 3 floats each.
std::vector<float> decoded(const std::vector<Rgbe>& texels);

/// A file's bytes, of the upright image `texels` (row 0 on top). Lengths that the new form cannot have are written
/// flat.
std::vector<char> hdr_bytes(const HdrRecipe& recipe, const std::vector<Rgbe>& texels);

/// Header, empty line and resolution line of a recipe.
std::string hdr_header(const HdrRecipe& recipe);

}  // namespace welkin::test
