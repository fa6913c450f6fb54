#include "support/hdr_files.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace welkin::test {
namespace {

void append(std::vector<char>& bytes, const Rgbe& texel) { bytes.insert(bytes.end(), texel.begin(), texel.end()); }

// Returns the length of the run that starts at texel `i`.
template <typename Same>
std::size_t run_length(std::size_t i, std::size_t end, std::size_t longest, const Same& same) {
  std::size_t length = 1;
  while (length < longest && i + length < end && same(i, i + length)) {
    ++length;
  }
  return length;
}

// Counts are written lowest byte first, each byte as a separate repeat; a byte of 0 is written too.
void append_old(std::vector<char>& bytes, const std::vector<Rgbe>& scanline) {
  const auto same = [&](std::size_t a, std::size_t b) { return scanline[a] == scanline[b]; };
  for (std::size_t i = 0; i < scanline.size();) {
    const std::size_t length = run_length(i, scanline.size(), scanline.size(), same);
    append(bytes, scanline[i]);
    for (std::size_t again = length - 1; again > 0; again /= 256) {
      append(bytes, {1, 1, 1, static_cast<std::uint8_t>(again % 256)});
    }
    i += length;
  }
}

void append_component(std::vector<char>& bytes, const std::vector<Rgbe>& scanline, std::size_t component) {
  const auto same = [&](std::size_t a, std::size_t b) { return scanline[a][component] == scanline[b][component]; };
  for (std::size_t i = 0; i < scanline.size();) {
    const std::size_t run = run_length(i, scanline.size(), 127, same);
    if (run >= 3) {
      bytes.push_back(static_cast<char>(128 + run));
      bytes.push_back(static_cast<char>(scanline[i][component]));
      i += run;
      continue;
    }
    const std::size_t start = i;
    while (i < scanline.size() && i - start < 128 && run_length(i, scanline.size(), 3, same) < 3) {
      ++i;
    }
    bytes.push_back(static_cast<char>(i - start));
    for (std::size_t k = start; k < i; ++k) {
      bytes.push_back(static_cast<char>(scanline[k][component]));
    }
  }
}

/// Returns one scanline in a form.
std::vector<char> scanline_bytes(HdrForm form, const std::vector<Rgbe>& scanline) {
  std::vector<char> bytes;
  const std::size_t length = scanline.size();
  if (form == HdrForm::new_rle && length >= 8 && length <= 32767) {
    bytes = {2, 2, static_cast<char>(length / 256), static_cast<char>(length % 256)};
    for (std::size_t component = 0; component < 4; ++component) {
      append_component(bytes, scanline, component);
    }
  } else if (form == HdrForm::old_rle) {
    append_old(bytes, scanline);
  } else {
    for (const Rgbe& texel : scanline) {
      append(bytes, texel);
    }
  }
  return bytes;
}

}  // namespace

std::vector<Rgbe> some_rgbe(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Rgbe> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::size_t i = 0; i < texels.size();) {
    const auto any = [&] { return static_cast<std::uint8_t>(random() % 256); };
    Rgbe texel{any(), any(), any(), static_cast<std::uint8_t>(120 + random() % 16)};
    switch (random() % 16) {
      case 0: texel = {0, 0, 0, 0}; break;
      case 1: texel[3] = 1; break;
      case 2: texel[3] = 255; break;
      case 3: texel = {2, 2, 200, 128}; break;  // begins as the new form does
      case 4: texel[3] = 0; break;              // darkness with a mantissa
      default: break;
    }
    texel[0] = texel[0] == 1 ? std::uint8_t{3} : texel[0];
    const std::size_t longest = random() % 8 == 0 ? 1500 : 4;
    const std::size_t run = std::min<std::size_t>(1 + random() % longest, texels.size() - i);
    std::fill_n(texels.begin() + static_cast<std::ptrdiff_t>(i), run, texel);
    i += run;
  }
  return texels;
}

std::vector<float> decoded(const std::vector<Rgbe>& texels) {
  std::vector<float> values;
  values.reserve(texels.size() * 3);
  for (const Rgbe& texel : texels) {
    for (std::size_t c = 0; c < 3; ++c) {
      values.push_back(texel[3] == 0 ? 0.0F : std::ldexp(static_cast<float>(texel[c]), texel[3] - 136));
    }
  }
  return values;
}

std::string hdr_header(const HdrRecipe& recipe) {
  std::string header = recipe.magic + "\n";
  for (const std::string& line : recipe.lines) {
    header += line + "\n";
  }
  const std::string y = (recipe.bottom_first ? "+Y " : "-Y ") + std::to_string(recipe.height);
  const std::string x = (recipe.right_first ? "-X " : "+X ") + std::to_string(recipe.width);
  return header + "\n" + (recipe.columns ? x + " " + y : y + " " + x) + "\n";
}

std::vector<char> hdr_bytes(const HdrRecipe& recipe, const std::vector<Rgbe>& texels) {
  const std::string header = hdr_header(recipe);
  std::vector<char> bytes(header.begin(), header.end());
  const int scanlines = recipe.columns ? recipe.width : recipe.height;
  const int length = recipe.columns ? recipe.height : recipe.width;
  for (int s = 0; s < scanlines; ++s) {
    std::vector<Rgbe> scanline;
    for (int i = 0; i < length; ++i) {
      int column = recipe.columns ? s : i;
      int row = recipe.columns ? i : s;
      column = recipe.right_first ? recipe.width - 1 - column : column;
      row = recipe.bottom_first ? recipe.height - 1 - row : row;
      scanline.push_back(texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(recipe.width) +
                                static_cast<std::size_t>(column)]);
    }
    const HdrForm form = recipe.form == HdrForm::mixed ? static_cast<HdrForm>(s % 3) : recipe.form;
    // A flat or old scanline that begins like the new form would be read as new, as Radiance does; texels with a third
    // byte of 128 or more are safe.
    const std::vector<char> coded = scanline_bytes(form, scanline);
    bytes.insert(bytes.end(), coded.begin(), coded.end());
  }
  return bytes;
}

}  // namespace welkin::test
