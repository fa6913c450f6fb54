#include "tools/preview_picture.h"

#include <cstddef>

namespace welkin::tool {

PreviewPicture::PreviewPicture(int width, int height, const glm::dvec3& background)
    : image_{width, height,
             std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)} {
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) set(column, row, background);
  }
}

void PreviewPicture::set(int column, int row, const glm::dvec3& rgb) {
  float* const pixel =
      image_.pixels.data() +
      (static_cast<std::size_t>(row) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(column)) * 3;
  for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(rgb[c]);
}

}  // namespace welkin::tool
