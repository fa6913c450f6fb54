// Cubemaps as images of every layout, assembled texel by texel from a drawing, without the library's code for layouts.
#pragma once

#include "support/catch.h"
#include "welkin/environment_file.h"

namespace welkin::test {

struct CubeImage {
  int width = 0;
  int height = 0;
  std::vector<float> pixels;  ///< width x height x 3, row 0 on top
};

/// Returns where faces lie: a digit is a face of CubemapView, a letter a face rotated by 180 degrees ('f' is face 5), a
/// dot nothing.
inline std::vector<std::string> drawing(Layout layout) {
  switch (layout) {
    case Layout::vertical_strip: return {"0", "1", "2", "3", "4", "5"};
    case Layout::horizontal_strip: return {"012345"};
    case Layout::horizontal_cross: return {".2..", "1405", ".3.."};
    case Layout::vertical_cross: return {".2.", "140", ".3.", ".f."};
    default: return {};
  }
}

inline const std::vector<Layout>& one_file_cube_layouts() {
  static const std::vector<Layout> layouts{Layout::vertical_strip, Layout::horizontal_strip, Layout::horizontal_cross,
                                           Layout::vertical_cross};
  return layouts;
}

/// Returns 6 x size x size x 3 floats, each texel different from every other; exact in a float up to size 1000.
inline std::vector<float> unlike_texels(int size) {
  std::vector<float> faces(std::size_t{18} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = static_cast<float>(i + 1) * 0.5F;
  return faces;
}

/// `faces`: 6 x size x size x 3. Pixels that no face covers are filled with `blank`.
inline CubeImage cube_image(Layout layout, int size, std::span<const float> faces, float blank) {
  const std::vector<std::string> rows = drawing(layout);
  CubeImage image;
  image.width = size * static_cast<int>(rows.front().size());
  image.height = size * static_cast<int>(rows.size());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const char mark = rows[static_cast<std::size_t>(y / size)][static_cast<std::size_t>(x / size)];
      const bool rotated = mark >= 'a';
      const int face = rotated ? mark - 'a' : mark - '0';
      const int column = rotated ? size - 1 - x % size : x % size;
      const int row = rotated ? size - 1 - y % size : y % size;
      for (int channel = 0; channel < 3; ++channel) {
        const int index = ((face * size + row) * size + column) * 3 + channel;
        image.pixels.push_back(mark == '.' ? blank : faces[static_cast<std::size_t>(index)]);
      }
    }
  }
  return image;
}

}  // namespace welkin::test
