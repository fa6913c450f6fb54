// Environments in memory that own their pixels.
#pragma once

#include <cstddef>
#include <vector>

#include "welkin/export.h"
#include "welkin/image_view.h"

namespace WELKIN_EXPORT welkin {

/// An RGB float lat-long picture that owns its pixels.
struct LatLongImage {
  int width = 0;              ///< texels; twice the height
  int height = 0;             ///< texels
  std::vector<float> pixels;  ///< width x height x 3, row 0 on top

  /// The pixels as a view. It is valid while `pixels` are.
  [[nodiscard]] LatLongView view() const noexcept { return {pixels.data(), width, height, 0, PixelFormat::rgb_f32}; }
};

/// An RGB float cubemap that owns its pixels.
struct CubemapImage {
  int size = 0;               ///< texels along an edge
  std::vector<float> pixels;  ///< 6 x size x size x 3: face after face, in the frames of `CubemapView`

  /// The pixels as a view. It is valid while `pixels` are.
  [[nodiscard]] CubemapView view() const noexcept {
    const std::size_t face_values = std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    CubemapView view{{}, size, 0, PixelFormat::rgb_f32};
    for (std::size_t face = 0; face < view.faces.size(); ++face) view.faces[face] = pixels.data() + face * face_values;
    return view;
  }
};

}  // namespace welkin
