// Coefficients of spherical harmonics, and what is done to them once a projection has made them.
#include "welkin/spherical_harmonics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "math/basis.h"
#include "math/direction.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "platform/float_environment.h"
#include "welkin/core.h"

namespace welkin {
namespace {

static_assert(kMaximumBands == math::kRecurrenceBands);

// The library is built without GLM's macros, where the interface's types are GLM's usual ones.
static_assert(std::is_same_v<vec3, glm::vec3> && std::is_same_v<dvec3, glm::dvec3>);
static_assert(std::is_same_v<dvec4, glm::dvec4> && std::is_same_v<dmat3, glm::dmat3>);

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
  const platform::FloatingPointScope floating_point;
  const std::size_t count = checked_coefficient_count(bands);
  if (values.size() < count) {
    throw Error(ErrorCode::invalid_argument, "values has " + std::to_string(values.size()) + " elements; " +
                                                 std::to_string(bands) + " bands need " + std::to_string(count));
  }
  const glm::dvec3 unit = math::as_unit_direction(direction, "direction");
  math::evaluate_basis(unit.x, unit.y, unit.z, bands, values.data());
}

glm::dvec3 evaluate(const SphericalHarmonics& coefficients, const glm::dvec3& direction) {
  const platform::FloatingPointScope floating_point;
  const glm::dvec3 unit = math::as_unit_direction(direction, "direction");
  std::array<double, kMaximumCoefficients> basis;
  math::evaluate_basis(unit.x, unit.y, unit.z, coefficients.bands(), basis.data());
  glm::dvec3 sum(0.0);
  std::size_t index = 0;
  for (const glm::dvec3& coefficient : coefficients.coefficients()) sum += coefficient * basis[index++];
  return sum;
}

// Equation 9 for even l > 0, with n = l / 2: 2 pi (-1)^(n - 1) / ((l + 2) (l - 1)) x l! / (2^l n!^2). The last
// factor, the central binomial coefficient over 4^n, is the product of (2k - 1) / (2k) over k = 1..n.
double cosine_lobe(int l) {
  const platform::FloatingPointScope floating_point;
  constexpr double kPi = std::numbers::pi;
  if (l == 1) return 2.0 * kPi / 3.0;
  if (l % 2 != 0) return 0.0;
  // At l = 0 the formula's denominator is -2 and its sign (-1)^-1: pi, as it must be.
  double lobe = -2.0 * kPi / ((static_cast<double>(l) + 2.0) * (static_cast<double>(l) - 1.0));
  for (int k = 1; k <= l / 2; ++k) lobe *= -(2.0 * k - 1.0) / (2.0 * k);
  return lobe;
}

SphericalHarmonics irradiance_from_radiance(const SphericalHarmonics& radiance) {
  const platform::FloatingPointScope floating_point;
  SphericalHarmonics irradiance = radiance;
  for (int l = 0; l < irradiance.bands(); ++l) {
    const double lobe = cosine_lobe(l);
    for (int m = -l; m <= l; ++m) irradiance.at(l, m) *= lobe;
  }
  return irradiance;
}

SphericalHarmonics lambertian_from_irradiance(const SphericalHarmonics& irradiance) {
  const platform::FloatingPointScope floating_point;
  SphericalHarmonics reflected = irradiance;
  for (glm::dvec3& coefficient : reflected.coefficients()) coefficient *= std::numbers::inv_pi;
  return reflected;
}

glm::dvec3 mean_radiance(const SphericalHarmonics& radiance) {
  const platform::FloatingPointScope floating_point;
  return radiance.at(0, 0) / band_zero_of_one();
}

namespace {

// Sums, multiples and cuts of coefficients.

/// factor_a a + factor_b b, with the bands of the longer one.
SphericalHarmonics combined(const SphericalHarmonics& a, double factor_a, const SphericalHarmonics& b,
                            double factor_b) {
  SphericalHarmonics sum(std::max(a.bands(), b.bands()));
  std::size_t k = 0;
  for (const glm::dvec3& value : a.coefficients()) sum.coefficients()[k++] = factor_a * value;
  k = 0;
  for (const glm::dvec3& value : b.coefficients()) sum.coefficients()[k++] += factor_b * value;
  return sum;
}

}  // namespace

SphericalHarmonics add(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  const platform::FloatingPointScope floating_point;
  return combined(a, 1.0, b, 1.0);
}

SphericalHarmonics scale(const SphericalHarmonics& a, const glm::dvec3& factor) {
  const platform::FloatingPointScope floating_point;
  SphericalHarmonics scaled = a;
  for (glm::dvec3& value : scaled.coefficients()) value *= factor;
  return scaled;
}

SphericalHarmonics lerp(const SphericalHarmonics& a, const SphericalHarmonics& b, double t) {
  const platform::FloatingPointScope floating_point;
  return combined(a, 1.0 - t, b, t);
}

SphericalHarmonics with_bands(const SphericalHarmonics& harmonics, int bands) {
  const platform::FloatingPointScope floating_point;
  SphericalHarmonics result(bands);
  const std::size_t kept = std::min(result.coefficients().size(), harmonics.coefficients().size());
  std::copy_n(harmonics.coefficients().begin(), kept, result.coefficients().begin());
  return result;
}

namespace {

// The product of two functions on the sphere, by a quadrature that is exact for its band limit.

glm::dvec3 sum_of(const SphericalHarmonics& harmonics, const std::vector<double>& basis) {
  glm::dvec3 sum(0.0);
  std::size_t k = 0;
  for (const glm::dvec3& coefficient : harmonics.coefficients()) sum += coefficient * basis[k++];
  return sum;
}

}  // namespace

// c(l, m) = Int a b Y(l, m): a polynomial of degree D = (bands of a - 1) + (of b - 1) + (of the result - 1) in the
// direction. In z a Gauss rule of D / 2 + 1 points is exact for it, along each circle D + 1 equal steps are. Both
// functions are summed in the same way, so that a b and b a have the same bits.
SphericalHarmonics product(const SphericalHarmonics& a, const SphericalHarmonics& b, int bands) {
  const platform::FloatingPointScope floating_point;
  if (bands < 0 || bands > kMaximumBands) {
    throw Error(ErrorCode::invalid_argument, "a product of " + std::to_string(bands) + " bands; 1 to " +
                                                 std::to_string(kMaximumBands) + " are possible, 0 for all there are");
  }
  const int limit = a.bands() + b.bands() - 1;
  const int wanted = bands == 0 ? std::min(limit, kMaximumBands) : bands;
  SphericalHarmonics result(std::min(wanted, limit));

  const int degree = a.bands() + b.bands() + result.bands() - 3;
  const math::GaussRule rule = math::gauss_legendre(degree / 2 + 1);
  const int azimuths = degree + 1;
  const int basis_bands = std::max({a.bands(), b.bands(), result.bands()});
  std::vector<double> basis(static_cast<std::size_t>(basis_bands * basis_bands));
  for (int i = 0; i < rule.order; ++i) {
    const double z = rule.nodes[i];
    const double ring = std::sqrt((1.0 - z) * (1.0 + z));
    const double weight = rule.weights[i] * (2.0 * std::numbers::pi / azimuths);
    for (int k = 0; k < azimuths; ++k) {
      const math::SineCosine azimuth = math::sine_cosine_of_turns(static_cast<double>(k) / azimuths);
      math::evaluate_basis(ring * azimuth.cosine, ring * azimuth.sine, z, basis_bands, basis.data());
      const glm::dvec3 value = weight * (sum_of(a, basis) * sum_of(b, basis));
      std::size_t at = 0;
      for (glm::dvec3& coefficient : result.coefficients()) coefficient += value * basis[at++];
    }
  }
  return with_bands(result, wanted);
}

}  // namespace welkin
