// A picture as rows of packed RGB floats, which need not lie one after the other: most may be the caller's own.
#pragma once

#include <cstddef>
#include <vector>

#include "welkin/image.h"

namespace welkin::transforms {

/// A lat-long of rgb32f rows, the northernmost first.
struct PictureRows {
  PictureRows() = default;
  /// Of a valid view of rgb32f pixels.
  explicit PictureRows(const LatLongView& view) : width(view.width), height(view.height) {
    const std::ptrdiff_t packed = std::ptrdiff_t{12} * width;
    const std::ptrdiff_t stride = view.row_stride_bytes != 0 ? view.row_stride_bytes : packed;
    const auto* at = static_cast<const std::byte*>(view.pixels);
    for (int k = 0; k < height; ++k, at += stride) rows.push_back(reinterpret_cast<const float*>(at));
  }

  [[nodiscard]] const float* row(int index) const noexcept { return rows[static_cast<std::size_t>(index)]; }

  int width = 0;
  int height = 0;
  std::vector<const float*> rows;
};

}  // namespace welkin::transforms
