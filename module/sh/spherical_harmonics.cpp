// Coefficients of spherical harmonics, and what is done to them once a projection has made them.
#include "welkin/spherical_harmonics.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "sh/basis.h"
#include "welkin/error.h"

namespace welkin {
namespace {

constexpr std::size_t kMaximumCoefficients = static_cast<std::size_t>(kMaximumBands) * kMaximumBands;

std::size_t checked_coefficient_count(int bands) {
  if (bands < 1 || bands > kMaximumBands) {
    throw Error(ErrorCode::invalid_argument,
                "bands = " + std::to_string(bands) + "; 1 to " + std::to_string(kMaximumBands) + " are possible");
  }
  return static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
}

/// 1 / Y(0, 0) = sqrt(4 pi): what turns a constant function into its band-0 coefficient.
double band_zero_of_one() noexcept { return std::sqrt(4.0 * std::numbers::pi); }

}  // namespace

SphericalHarmonics::SphericalHarmonics(int bands)
    : bands_(bands), values_(checked_coefficient_count(bands), glm::dvec3(0.0)) {}

void evaluate_basis(const glm::dvec3& direction, int bands, std::span<double> values) {
  const std::size_t count = checked_coefficient_count(bands);
  if (values.size() < count) {
    throw Error(ErrorCode::invalid_argument, "room for " + std::to_string(values.size()) + " basis values; " +
                                                 std::to_string(bands) + " bands have " + std::to_string(count));
  }
  sh::evaluate_basis(direction.x, direction.y, direction.z, bands, values.data());
}

glm::dvec3 evaluate(const SphericalHarmonics& coefficients, const glm::dvec3& direction) {
  std::array<double, kMaximumCoefficients> basis;
  sh::evaluate_basis(direction.x, direction.y, direction.z, coefficients.bands(), basis.data());
  glm::dvec3 sum(0.0);
  std::size_t index = 0;
  for (const glm::dvec3& coefficient : coefficients.coefficients()) sum += coefficient * basis[index++];
  return sum;
}

// Equation 9 for even l > 0, with n = l / 2: 2 pi (-1)^(n - 1) / ((l + 2) (l - 1)) x l! / (2^l n!^2). The last
// factor, the central binomial coefficient over 4^n, is the product of (2k - 1) / (2k) over k = 1..n.
double cosine_lobe(int l) {
  constexpr double kPi = std::numbers::pi;
  if (l == 1) return 2.0 * kPi / 3.0;
  if (l % 2 != 0) return 0.0;
  // At l = 0 the formula's denominator is -2 and its sign (-1)^-1: pi, as it must be.
  double lobe = -2.0 * kPi / ((static_cast<double>(l) + 2.0) * (static_cast<double>(l) - 1.0));
  for (int k = 1; k <= l / 2; ++k) lobe *= -(2.0 * k - 1.0) / (2.0 * k);
  return lobe;
}

SphericalHarmonics irradiance_from_radiance(const SphericalHarmonics& radiance) {
  SphericalHarmonics irradiance = radiance;
  for (int l = 0; l < irradiance.bands(); ++l) {
    const double lobe = cosine_lobe(l);
    for (int m = -l; m <= l; ++m) irradiance.at(l, m) *= lobe;
  }
  return irradiance;
}

SphericalHarmonics lambertian_from_irradiance(const SphericalHarmonics& irradiance) {
  SphericalHarmonics reflected = irradiance;
  for (glm::dvec3& coefficient : reflected.coefficients()) coefficient *= std::numbers::inv_pi;
  return reflected;
}

SphericalHarmonics constant_radiance(const glm::dvec3& radiance, int bands) {
  SphericalHarmonics harmonics(bands);
  harmonics.at(0, 0) = radiance * band_zero_of_one();
  return harmonics;
}

glm::dvec3 average_radiance(const SphericalHarmonics& radiance) { return radiance.at(0, 0) / band_zero_of_one(); }

}  // namespace welkin
