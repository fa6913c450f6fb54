// One directional light in place of an environment's lower bands.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "welkin/directional_light.h"

namespace welkin {
namespace {

/// The linear band as a share of band 0, below which it is taken for rounding: a projection of uniform light leaves
/// 1e-7 there.
constexpr double kNoDirection = 1e-6;
constexpr int kFittedBands = 3;

double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

}  // namespace

// A light of irradiance E from direction d has the coefficients E Y(l, m)(d). Least squares over bands 1 and 2:
// E = sum c(l, m) Y(l, m)(d) / sum Y(l, m)(d)^2, and the second sum is (3 + 5) / (4 pi) whatever d is.
std::optional<DominantLight> dominant_light(const SphericalHarmonics& radiance) {
  if (radiance.bands() < 2) return std::nullopt;
  const glm::dvec3 linear(luminance(radiance.at(1, 1)), luminance(radiance.at(1, -1)), luminance(radiance.at(1, 0)));
  const double largest = std::max({std::abs(linear.x), std::abs(linear.y), std::abs(linear.z)});
  if (!std::isfinite(linear.x + linear.y + linear.z)) return std::nullopt;
  if (!(largest > kNoDirection * std::abs(luminance(radiance.at(0, 0))))) return std::nullopt;

  DominantLight light;
  light.direction = glm::normalize(linear / largest);  // divided first: no square over- or underflows
  const int bands = std::min(radiance.bands(), kFittedBands);
  double basis[kFittedBands * kFittedBands];
  evaluate_basis(light.direction, bands, basis);
  double squares = 0.0;
  for (int k = 1; k < bands * bands; ++k) {
    light.irradiance += basis[k] * radiance.coefficients()[static_cast<std::size_t>(k)];
    squares += basis[k] * basis[k];
  }
  light.irradiance = glm::max(light.irradiance / squares, glm::dvec3(0.0));
  return light;
}

}  // namespace welkin
