#include "tools/pixels.h"

#include <algorithm>
#include <cmath>

namespace welkin::tool {

Pixels pixels_of(const Environment& environment) {
  const float* const values = environment.pixels.get();
  const auto count = [](int width, int height) {
    return std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  };
  Pixels pixels;
  if (const int size = environment.face_size(); size > 0) {
    pixels.is_cubemap = true;
    pixels.cubemap = {size, {values, values + 6 * count(size, size)}};
  } else {
    const LatLongView view = environment.lat_long();
    pixels.lat_long = {view.width, view.height, {values, values + count(view.width, view.height)}};
  }
  return pixels;
}

std::uint64_t replace_infinities(Pixels& pixels, float largest) {
  std::uint64_t replaced = 0;
  for (float& value : pixels.is_cubemap ? pixels.cubemap.pixels : pixels.lat_long.pixels) {
    if (!std::isinf(value)) continue;
    value = value > 0.0F ? largest : 0.0F;
    ++replaced;
  }
  return replaced;
}

std::optional<Sun> take_out_sun(Pixels& pixels, const SunOptions& options) {
  return pixels.is_cubemap ? welkin::take_out_sun(pixels.cubemap, options)
                           : welkin::take_out_sun(pixels.lat_long, options);
}

std::optional<Sun> take_out_sun(Environment& environment, const SunOptions& options) {
  constexpr float kLargestHalf = 65504.0F;
  Pixels pixels = pixels_of(environment);
  replace_infinities(pixels, kLargestHalf);
  const std::optional<Sun> sun = take_out_sun(pixels, options);
  const std::vector<float>& values = pixels.is_cubemap ? pixels.cubemap.pixels : pixels.lat_long.pixels;
  std::copy(values.begin(), values.end(), environment.pixels.get());
  return sun;
}

}  // namespace welkin::tool
