// A small sky that needs no file: gradient, sun and ground.
#pragma once

#include <vector>

#include "welkin/image_view.h"

namespace welkin {

/// An RGB float lat-long picture that owns its pixels.
struct LatLongImage {
  int width = 0;
  int height = 0;
  std::vector<float> pixels;  ///< width x height x 3, row 0 on top

  [[nodiscard]] LatLongView view() const noexcept { return {pixels.data(), width, height, 0, PixelFormat::rgb_f32}; }
};

/// A clear day as an example and as the command's default input: a blue gradient that pales towards the
/// horizon, a warm sun 40 degrees up towards +z and a little to +x, dark ground. Not physics, but the same
/// bits on every machine. `height` >= 1 (width is twice that), else `Error` (invalid_argument).
[[nodiscard]] LatLongImage analytic_sky(int height = 512);

}  // namespace welkin
