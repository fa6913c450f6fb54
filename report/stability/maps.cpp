#include "report/stability/maps.h"

#include <cstddef>

#include "image/texel_geometry.h"

namespace welkin::report::stability {
namespace {

CubemapImage cube_of(int size) {
  const auto edge = static_cast<std::size_t>(size);
  return {size, std::vector<float>(18 * edge * edge)};
}

LatLongImage lat_long_of(int width, int height) {
  return {width, height, std::vector<float>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

template <class Image, class Value>
Image filled(Image image, const Value& value) {
  for (std::size_t k = 0; k < image.pixels.size(); ++k) image.pixels[k] = value(k);
  return image;
}

/// Of a value's place among rows of `width` texels, and the row.
float board(std::size_t value, int width, float amplitude) {
  const std::size_t texel = value / 3;
  const auto columns = static_cast<std::size_t>(width);
  return (texel / columns + texel % columns) % 2 == 0 ? amplitude : -amplitude;
}

}  // namespace

std::uint32_t hashed(std::uint32_t seed, std::uint32_t index) noexcept {
  std::uint32_t h = index + 0x9E3779B9U * (seed + 1U);
  h = (h ^ (h >> 16U)) * 0x85EBCA6BU;
  h = (h ^ (h >> 13U)) * 0xC2B2AE35U;
  return h ^ (h >> 16U);
}

float noise(std::uint32_t seed, std::uint32_t index) noexcept {
  return static_cast<float>(hashed(seed, index) >> 8U) * 0x1p-24F;
}

CubemapImage uniform_cube(int size, float value) {
  return filled(cube_of(size), [value](std::size_t) { return value; });
}

LatLongImage uniform_lat_long(int width, int height, float value) {
  return filled(lat_long_of(width, height), [value](std::size_t) { return value; });
}

CubemapImage noise_cube(int size, std::uint32_t seed) {
  return filled(cube_of(size), [seed](std::size_t k) { return noise(seed, static_cast<std::uint32_t>(k)); });
}

LatLongImage noise_lat_long(int width, int height, std::uint32_t seed) {
  return filled(lat_long_of(width, height),
                [seed](std::size_t k) { return noise(seed, static_cast<std::uint32_t>(k)); });
}

CubemapImage checkerboard_cube(int size, float amplitude) {
  return filled(cube_of(size), [=](std::size_t k) { return board(k, size, amplitude); });
}

LatLongImage checkerboard_lat_long(int width, int height, float amplitude) {
  return filled(lat_long_of(width, height), [=](std::size_t k) { return board(k, width, amplitude); });
}

CubemapImage upper_half_cube(int size) {
  const auto edge = static_cast<std::size_t>(size);
  return filled(cube_of(size), [=](std::size_t k) {
    const std::size_t texel = k / 3;
    const std::size_t row = texel / edge % edge;
    const auto face = static_cast<int>(texel / (edge * edge));
    const auto column = static_cast<double>(texel % edge);
    return image::face_direction(size, face, column + 0.5, static_cast<double>(row) + 0.5).y > 0.0 ? 1.0F : 0.0F;
  });
}

LatLongImage upper_half_lat_long(int width, int height) {
  const std::size_t half = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height / 2);
  return filled(lat_long_of(width, height), [half](std::size_t k) { return k < half ? 1.0F : 0.0F; });
}

}  // namespace welkin::report::stability
