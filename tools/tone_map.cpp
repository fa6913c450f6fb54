#include "tools/tone_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace welkin::tool {
namespace {

constexpr double kMiddleGrey = 0.18;
constexpr double kBright = 4.0;

double curve(double x) {
  const double light = std::max(x, 0.0);  // false for NaN, which so becomes 0
  if (light > 1e6) return 1.0;
  return std::min(1.0, light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14));
}

/// The mean over all texels whose luminance is at most `limit`, weighted by 1 / (1 + u^2 + v^2)^1.5: solid angle but
/// for a factor. 0 if there are none.
double mean_luminance(const CubemapView& level, double limit) {
  double sum = 0.0;
  double weights = 0.0;
  for (const void* const face : level.faces) {
    const auto* rgb = static_cast<const float*>(face);
    for (int row = 0; row < level.size; ++row) {
      const double v = (2.0 * row + 1.0) / level.size - 1.0;
      for (int column = 0; column < level.size; ++column, rgb += 3) {
        const double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        if (!(luminance <= limit)) continue;
        const double u = (2.0 * column + 1.0) / level.size - 1.0;
        const double squared = 1.0 + u * u + v * v;
        const double weight = 1.0 / (squared * std::sqrt(squared));
        sum += weight * std::max(luminance, 0.0);
        weights += weight;
      }
    }
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

}  // namespace

glm::dvec3 ToneMap::operator()(const glm::dvec3& radiance) const noexcept {
  return {curve(exposure * radiance.x), curve(exposure * radiance.y), curve(exposure * radiance.z)};
}

ToneMap tone_map_of(const CubemapView& level) {
  double mean = mean_luminance(level, std::numeric_limits<double>::max());
  for (int step = 0; step < 6 && mean > 0.0; ++step) {  // each leaves out what was too bright for the one before
    const double rest = mean_luminance(level, kBright * mean);
    if (!(rest < mean)) break;
    mean = rest;
  }
  return mean > 0.0 && std::isfinite(kMiddleGrey / mean) ? ToneMap{kMiddleGrey / mean} : ToneMap{};
}

}  // namespace welkin::tool
