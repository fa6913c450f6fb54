#include "reflections/radiance_scale.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace welkin::reflections {
namespace {

constexpr float kHuge = 1e18F;      ///< sums of squares of what is larger may exceed the range of floats
constexpr float kDown = 0x1p-100F;  ///< makes of the largest float 2.7e8
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

ScaledSource::ScaledSource(const projection::SanitizedSource& source, float scale, const Control& control) {
  if (source.cubemap()) {
    cube_ = {source.columns(), scaled_pixels(source, scale)};
    source_.emplace(cube_.view(), PixelPolicy{}, control);
  } else {
    lat_long_ = {source.columns(), source.rows(), scaled_pixels(source, scale)};
    source_.emplace(lat_long_.view(), PixelPolicy{}, control);
  }
}

void undo_scale(PrefilteredSpecular& result, float scale) {
  static constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  const double back = 1.0 / static_cast<double>(scale);
  Cubemap& chain = result.cubemap;
  for (int level = 0; level < chain.levels(); ++level) {
    const auto edge = static_cast<std::size_t>(chain.level_size(level));
    float* const values = chain.face(level, 0);
    std::transform(values, values + 18 * edge * edge, values, [back](float value) {
      return static_cast<float>(std::clamp(back * static_cast<double>(value), -most, most));
    });
  }
  for (MipRecord& mip : result.mips) mip.mean *= back;
}

}  // namespace welkin::reflections
