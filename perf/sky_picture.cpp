#include "sky_picture.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace welkin::perf {

LatLongImage sky_picture(const SkyPictureOptions& options) {
  constexpr int kWidth = 1024;
  constexpr int kHeight = 512;
  LatLongImage image{kWidth, kHeight, {}};
  std::uint32_t state = 1;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      state = state * 1664525U + 1013904223U;
      const double grain = options.grain * static_cast<double>(state >> 8U) / (1U << 24U);
      const double clouds =
          0.3 * std::sin(0.03 * column) * std::sin(0.02 * row) + options.ripples * std::sin(0.4 * column + 0.3 * row);
      const double light = (row < kHeight / 2 ? 1.0 : 0.3) + clouds;
      const bool sun = options.sun > 0.0 && std::hypot(column - 300, row - 150) < 4.0;
      const double tint = 0.5 + 0.4 * std::sin(0.011 * column + 0.017 * row);
      const std::array<double, 3> shares =
          options.tinted ? std::array{1.0, tint, 1.0 - 0.5 * tint} : std::array{1.0, 0.9, 0.7};
      for (const double share : shares) {
        const double value = light * share + grain * (options.tinted ? 1.0 : share);
        image.pixels.push_back(static_cast<float>(sun ? options.sun * share : value));
      }
    }
  }
  return image;
}

}  // namespace welkin::perf
