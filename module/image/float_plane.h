// A picture's rows, and the same as RGB floats that can be looked up at random.
#pragma once

#include <cstddef>
#include <memory>

#include "welkin/image_view.h"

namespace welkin::image {

/// First texel of a row, whichever way the rows run.
[[nodiscard]] const void* row_of(const LatLongView& view, int row) noexcept;
[[nodiscard]] const void* row_of(const CubemapView& view, int face, int row) noexcept;

/// RGB floats: the caller's own where they are that already, else a decoded copy.
class FloatPlane {
 public:
  explicit FloatPlane(const LatLongView& view);
  FloatPlane(const CubemapView& view, int face);

  /// Three values.
  [[nodiscard]] const float* texel(int column, int row) const noexcept {
    return first_ + row * row_floats_ + std::ptrdiff_t{3} * column;
  }

 private:
  template <typename RowOf>
  FloatPlane(PixelFormat format, int width, int height, const RowOf& address_of_row);

  std::unique_ptr<float[]> decoded_;
  const float* first_ = nullptr;
  std::ptrdiff_t row_floats_ = 0;
};

}  // namespace welkin::image
