#include "reflections/prefilter_source.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "image/area_resampling.h"
#include "image/pixels.h"

namespace welkin::reflections {
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

namespace {

constexpr float kHuge = 1e30F;
constexpr float kDown = 0x1p-64F;
constexpr float kDark = 1e-25F;
constexpr float kUp = 0x1p100F;

float largest_magnitude(const projection::SanitizedSource& source) noexcept {
  float largest = 0.0F;
  for (int row = 0; row < source.rows(); ++row)
    largest = std::max({largest, source.range(row).largest, -source.range(row).least});
  return largest;
}

std::vector<float> scaled_pixels(const projection::SanitizedSource& source, float scale) {
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.columns());
  std::vector<float> pixels;
  pixels.reserve(row_values * static_cast<std::size_t>(source.rows()));
  for (int row = 0; row < source.rows(); ++row) {
    const float* const values = source.row(row);
    for (std::size_t k = 0; k < row_values; ++k) pixels.push_back(values[k] * scale);
  }
  return pixels;
}

}  // namespace

float safe_scale(const projection::SanitizedSource& source) noexcept {
  const float largest = largest_magnitude(source);
  if (largest > kHuge) return kDown;
  return largest > 0.0F && largest < kDark ? kUp : 1.0F;
}

LatLongImage scaled(const projection::SanitizedSource& source, const LatLongView& /*view*/, float scale) {
  return {source.columns(), source.rows(), scaled_pixels(source, scale)};
}

CubemapImage scaled(const projection::SanitizedSource& source, const CubemapView& /*view*/, float scale) {
  return {source.columns(), scaled_pixels(source, scale)};
}

void undo_scale(Prefiltered& result, float scale) {
  static constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  const double back = 1.0 / static_cast<double>(scale);
  CubemapChain& chain = result.specular.cubemap;
  for (int level = 0; level < chain.levels(); ++level) {
    const auto edge = static_cast<std::size_t>(chain.level_size(level));
    float* const values = chain.face(level, 0);
    std::transform(values, values + 18 * edge * edge, values, [back](float value) {
      return static_cast<float>(std::clamp(back * static_cast<double>(value), -most, most));
    });
  }
  for (MipRecord& mip : result.specular.mips) mip.mean *= back;
  if (!result.harmonics) return;
  for (glm::dvec3& coefficient : result.harmonics->coefficients()) coefficient *= back;
}

}  // namespace welkin::reflections
