// One directional light in place of an environment's lower bands.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "math/basis.h"
#include "math/direction.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

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
  const platform::FloatingPointScope floating_point;
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

namespace {

// The harmonics of a uniform disc on the sphere.

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

}  // namespace

// A cap of radiance L and angular radius a around z has c(l, 0) = 2 pi L sqrt((2l + 1) / 4 pi) Int from c to 1 of P_l,
// c = cos a, and Legendre's equation integrates to (1 - c^2) P_l'(c) / (l (l + 1)): with the usual difference of
// P_(l - 1) and P_(l + 1) a sun of 1e-8 sr would lose half its digits. With t = 1 - c = solid angle / 2 pi, rotated
// to d:
//   c(l, m) = L solid_angle k_l Y(l, m)(d),   k_l = (2 - t) P_l'(1 - t) / (l (l + 1)),   k_0 = 1,
// and k_l goes to 1 as the disc shrinks to a point.
SphericalHarmonics sun_harmonics(const Sun& sun, int bands) {
  const platform::FloatingPointScope floating_point;
  SphericalHarmonics harmonics(bands);
  if (!(sun.solid_angle >= 0.0 && sun.solid_angle <= 4.0 * std::numbers::pi)) {
    refuse("the sun's solid angle is " + platform::number_text(sun.solid_angle) + " sr; it must be from 0 to 4 pi");
  }
  const glm::dvec3 direction = math::unit_direction(sun.direction, "the sun's direction");
  std::vector<double> basis(harmonics.coefficients().size());
  math::evaluate_basis(direction.x, direction.y, direction.z, bands, basis.data());

  const double t = sun.solid_angle / (2.0 * std::numbers::pi);
  const double c = 1.0 - t;
  double legendre = 1.0;  // P_(l - 1)(c)
  double before = 0.0;    // P_(l - 2)(c)
  double slope = 0.0;     // P_(l - 1)'(c)
  harmonics.at(0, 0) = sun.irradiance * basis[0];
  for (int l = 1; l < bands; ++l) {
    slope = l * legendre + c * slope;  // P_l' = l P_(l - 1) + c P_(l - 1)'
    const double factor = (2.0 - t) * slope / (l * (l + 1.0));
    for (int m = -l; m <= l; ++m)
      harmonics.at(l, m) = sun.irradiance * (factor * basis[SphericalHarmonics::index(l, m)]);
    const double next = ((2.0 * l - 1.0) * c * legendre - (l - 1.0) * before) / l;
    before = legendre;
    legendre = next;
  }
  return harmonics;
}

}  // namespace welkin
