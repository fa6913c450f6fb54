// A lat-long as texels of four floats, going on round the seam.
#pragma once

#include <cstddef>

#include "tables/aligned_buffer.h"
#include "welkin/control.h"
#include "welkin/image_view.h"

namespace welkin::image {

/// Red, green, blue and 0 for each texel, and `border` more texels at both ends of each row: those round the seam.
class PaddedPicture {
 public:
  PaddedPicture(const LatLongView& source, int border, const Control& control);

  [[nodiscard]] const float* texel(int column, int row) const noexcept {
    return values_.data() + row * stride() + std::ptrdiff_t{4} * (column + border_);
  }
  /// Floats from a row to the next.
  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return std::ptrdiff_t{4} * (width_ + 2 * border_); }

 private:
  int width_;
  int border_;
  tables::AlignedBuffer<float> values_;
};

}  // namespace welkin::image
