// Small environments for the cases: the same bits on every machine.
#pragma once

#include <array>
#include <cstdint>

#include "welkin/image.h"

namespace welkin::report::stability {

/// Whole numbers that look random: the same for the same seed and index (a finaliser in the manner of murmur3).
[[nodiscard]] std::uint32_t hashed(std::uint32_t seed, std::uint32_t index) noexcept;
/// In [0, 1), exact in float.
[[nodiscard]] float noise(std::uint32_t seed, std::uint32_t index) noexcept;

[[nodiscard]] CubemapImage uniform_cube(int size, float value);
[[nodiscard]] LatLongImage uniform_lat_long(int width, int height, float value);
[[nodiscard]] CubemapImage noise_cube(int size, std::uint32_t seed);
[[nodiscard]] LatLongImage noise_lat_long(int width, int height, std::uint32_t seed);

/// The same with all channels of one texel (counted from the first face's first) set.
template <class Image>
[[nodiscard]] Image with_texel(Image image, std::size_t texel, float value) {
  for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * texel + c] = value;
  return image;
}

/// +size and -size by turns along rows and columns.
[[nodiscard]] CubemapImage checkerboard_cube(int size, float amplitude);
[[nodiscard]] LatLongImage checkerboard_lat_long(int width, int height, float amplitude);

/// 1 above the horizon, 0 below. `size` even.
[[nodiscard]] CubemapImage upper_half_cube(int size);
[[nodiscard]] LatLongImage upper_half_lat_long(int width, int height);

}  // namespace welkin::report::stability
