#include "specular/huge_values.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace welkin::specular {
namespace {

constexpr float kHuge = 1e30F;
constexpr float kDown = 0x1p-64F;
constexpr double kUp = 0x1p64;

std::vector<float> scaled_pixels(const CleanSource& source) {
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.columns());
  std::vector<float> pixels;
  pixels.reserve(row_values * static_cast<std::size_t>(source.rows()));
  for (int row = 0; row < source.rows(); ++row) {
    const float* const values = source.row(row);
    for (std::size_t k = 0; k < row_values; ++k) pixels.push_back(values[k] * kDown);
  }
  return pixels;
}

}  // namespace

bool has_huge_values(const CleanSource& source) noexcept {
  for (int row = 0; row < source.rows(); ++row) {
    if (source.range(row).largest > kHuge || source.range(row).least < -kHuge) return true;
  }
  return false;
}

LatLongImage scaled_down(const CleanSource& source, const LatLongView& /*view*/) {
  return {source.columns(), source.rows(), scaled_pixels(source)};
}

CubemapImage scaled_down(const CleanSource& source, const CubemapView& /*view*/) {
  return {source.columns(), scaled_pixels(source)};
}

void scale_up(Prefiltered& result) {
  static constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  CubemapChain& chain = result.specular.cubemap;
  for (int level = 0; level < chain.levels(); ++level) {
    const auto edge = static_cast<std::size_t>(chain.level_size(level));
    float* const values = chain.face(level, 0);
    std::transform(values, values + 18 * edge * edge, values, [](float value) {
      return static_cast<float>(std::clamp(kUp * static_cast<double>(value), -most, most));
    });
  }
  for (MipRecord& mip : result.specular.mips) mip.mean *= kUp;
  if (!result.harmonics) return;
  for (glm::dvec3& coefficient : result.harmonics->coefficients()) coefficient *= kUp;
}

}  // namespace welkin::specular
