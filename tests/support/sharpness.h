// How sharp a lat-long picture is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "welkin/image.h"

namespace welkin::test {

/// The mean, over all pixels, of the gradient of log2 luminance: stops a pixel. Blur lowers it.
inline double sharpness(const LatLongView& picture) {
  const auto* const pixels = static_cast<const float*>(picture.pixels);
  const auto stops = [&](int column, int row) {
    const float* const rgb = pixels + (static_cast<std::ptrdiff_t>(row) * picture.width + column % picture.width) * 3;
    const double luminance = 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
                             0.0722 * static_cast<double>(rgb[2]);
    return std::log2(std::max(luminance, 1e-6));
  };
  double sum = 0.0;
  for (int row = 0; row + 1 < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const double here = stops(column, row);
      sum += std::hypot(stops(column + 1, row) - here, stops(column, row + 1) - here);
    }
  }
  return sum / (static_cast<double>(picture.height - 1) * picture.width);
}

}  // namespace welkin::test
