#include "specular/cube_rings.h"

#include <algorithm>
#include <cstddef>

#include "image/area_cubemap.h"
#include "image/float_plane.h"

namespace welkin::specular {
namespace {

/// Each texel `parts` x `parts` times.
CubemapImage cut(const CubemapView& source, int parts) {
  const auto row_values = std::ptrdiff_t{3} * source.size;
  const auto cut_values = row_values * parts;
  CubemapImage result{source.size * parts, {}};
  result.pixels.resize(static_cast<std::size_t>(6 * cut_values) * static_cast<std::size_t>(result.size));
  float* to = result.pixels.data();
  for (int row = 0; row < 6 * source.size; ++row) {
    const auto* const from = static_cast<const float*>(image::row_of(source, row / source.size, row % source.size));
    float* const first = to;
    for (int column = 0; column < source.size; ++column) {
      for (int part = 0; part < parts; ++part, to += 3) std::copy_n(from + std::ptrdiff_t{3} * column, 3, to);
    }
    for (int part = 1; part < parts; ++part, to += cut_values) std::copy_n(first, cut_values, to);
  }
  return result;
}

}  // namespace

LatLongImage rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  LatLongImage rings{2 * rows, rows, {}};
  rings.pixels.resize(std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows));
  const int parts = std::max(1, rows / (2 * source.size));
  if (parts == 1) {
    image::fill_lat_long_by_area(source, 2 * rows, rows, rings.pixels.data(), control);
  } else {
    image::fill_lat_long_by_area(cut(source, parts).view(), 2 * rows, rows, rings.pixels.data(), control);
  }
  return rings;
}

}  // namespace welkin::specular
