// An image as rows of packed RGB floats, which need not lie one after the other: most may be the caller's own.
#pragma once

#include <cstddef>
#include <vector>

#include "image/pixels.h"
#include "welkin/image.h"

namespace welkin::transforms {

/// A lat-long of rgb32f rows, the northernmost first.
struct ImageRows {
  ImageRows() = default;
  /// `view`: valid, of rgb32f pixels.
  explicit ImageRows(const LatLongView& view) : width(view.width), height(view.height) {
    for (int row = 0; row < height; ++row) rows.push_back(static_cast<const float*>(image::row_of(view, row)));
  }

  [[nodiscard]] const float* row(int index) const noexcept { return rows[static_cast<std::size_t>(index)]; }

  int width = 0;
  int height = 0;
  std::vector<const float*> rows;
};

}  // namespace welkin::transforms
