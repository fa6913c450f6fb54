// A picture for people: what the previews are drawn on.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "welkin/image.h"

namespace welkin::tool {

/// Linear light from 0 to 1, already tone mapped.
class PreviewPicture {
 public:
  PreviewPicture(int width, int height, const glm::dvec3& background);

  [[nodiscard]] int width() const noexcept { return image_.width; }
  [[nodiscard]] int height() const noexcept { return image_.height; }
  void set(int column, int row, const glm::dvec3& rgb);

  /// For the writer, which takes a picture of any shape.
  [[nodiscard]] LatLongView view() const noexcept { return image_.view(); }

 private:
  LatLongImage image_;
};

/// The mean of `shade(x, y)` over a pixel, at n x n points of it; x and y are in pixels from the picture's top left.
template <typename Shade>
glm::dvec3 supersampled(int column, int row, int n, const Shade& shade) {
  glm::dvec3 sum(0.0);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) sum += shade(column + (i + 0.5) / n, row + (j + 0.5) / n);
  }
  return sum / (static_cast<double>(n) * n);
}

}  // namespace welkin::tool
