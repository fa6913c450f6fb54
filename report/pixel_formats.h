// The same pixels in every format that Welkin reads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "welkin/image.h"

namespace welkin::report {

/// "rgb32f", "rgba32f", "rgba16f", "rgb16f", "rgb8", "rgb8srgb", ...
[[nodiscard]] std::string name(PixelFormat format);

/// A cubemap's pixels in another format: halves by GLM, at most 65504; bytes rounded to nearest from values clamped to
/// 0 to 1; alpha is 1.
class FormattedCubemap {
 public:
  FormattedCubemap(const CubemapImage& image, PixelFormat format);
  [[nodiscard]] CubemapView view() const noexcept;

 private:
  int size_;
  PixelFormat format_;
  std::vector<std::byte> bytes_;
};

}  // namespace welkin::report
