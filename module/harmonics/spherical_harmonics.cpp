// Coefficients of spherical harmonics, and what is done to them once a projection has made them.
#include "welkin/spherical_harmonics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "harmonics/harmonics_kernels.h"
#include "math/basis.h"
#include "math/direction.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "platform/memory.h"
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
/// Int 1 Y(0, 0) over the sphere = 4 pi / sqrt(4 pi).
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

void evaluate(const SphericalHarmonics& coefficients, std::span<const dvec3> directions, std::span<dvec3> values) {
  const platform::FloatingPointScope floating_point;
  if (values.size() < directions.size()) {
    throw Error(ErrorCode::invalid_argument, "values has " + std::to_string(values.size()) + " elements for " +
                                                 std::to_string(directions.size()) + " directions");
  }
  constexpr int kLanes = harmonics::kPointLanes;
  constexpr auto kPoints = static_cast<std::size_t>(kLanes);
  const harmonics::HarmonicsKernels& kernels = harmonics::harmonics_kernels();
  const math::BasisRecurrence& recurrence = math::basis_constants();
  const auto functions = static_cast<int>(coefficients.coefficients().size());
  alignas(64) std::array<double, kPoints * kMaximumCoefficients> basis;
  alignas(64) double axes[3][kPoints];
  alignas(64) double sums[3][kPoints];
  for (std::size_t first = 0; first < directions.size(); first += kPoints) {
    const std::size_t here = std::min(kPoints, directions.size() - first);
    for (std::size_t k = 0; k < kPoints; ++k) {
      const glm::dvec3 unit = math::as_unit_direction(directions[first + std::min(k, here - 1)], "direction");
      for (int c = 0; c < 3; ++c) axes[c][k] = unit[c];
    }
    kernels.evaluate(recurrence, coefficients.bands(), axes[0], kLanes, basis.data());
    kernels.sum(&coefficients.coefficients()[0].x, functions, basis.data(), kLanes, sums[0]);
    for (std::size_t k = 0; k < here; ++k) values[first + k] = {sums[0][k], sums[1][k], sums[2][k]};
  }
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

SphericalHarmonics resized(const SphericalHarmonics& harmonics, int bands) {
  const platform::FloatingPointScope floating_point;
  SphericalHarmonics result(bands);
  const std::size_t kept = std::min(result.coefficients().size(), harmonics.coefficients().size());
  std::copy_n(harmonics.coefficients().begin(), kept, result.coefficients().begin());
  return result;
}

namespace {

// The product of two functions on the sphere, by a quadrature that is exact for its band limit.

struct PointsKey {
  int degree;
  int bands;

  bool operator==(const PointsKey&) const = default;
};

/// Points by which polynomials of that degree are integrated, and the harmonics there.
class ProductPoints {
 public:
  /// In z a Gauss rule of degree / 2 + 1 points is exact, along each circle degree + 1 equal steps are.
  explicit ProductPoints(const PointsKey& key)
      : azimuths_(key.degree + 1),
        count_((azimuths_ * (key.degree / 2 + 1) + harmonics::kPointLanes - 1) / harmonics::kPointLanes *
               harmonics::kPointLanes),
        weights_(static_cast<std::size_t>(count_)),
        basis_(static_cast<std::size_t>(key.bands * key.bands * count_)) {
    // n Gauss points are exact up to the degree 2 n - 1, which is `degree` or one more. On a circle the sum of
    // e^(i m phi) over D + 1 equal steps is 0 for 0 < |m| <= D, as the integral is; what is odd in sin(theta) has an
    // odd order and is among those.
    const math::GaussRule rule = math::gauss_legendre(key.degree / 2 + 1);
    platform::AlignedBuffer<double> axes(static_cast<std::size_t>(3 * count_));
    for (int p = 0; p < count_; ++p) {
      const bool counts = p < azimuths_ * rule.order;  // the others fill up the lanes
      const int ring = counts ? p / azimuths_ : 0;
      const double z = rule.nodes[ring];
      const double radius = std::sqrt((1.0 - z) * (1.0 + z));
      const math::SineCosine azimuth = math::sine_cosine_of_turns(static_cast<double>(p % azimuths_) / azimuths_);
      axes.data()[p] = radius * azimuth.cosine;
      axes.data()[count_ + p] = radius * azimuth.sine;
      axes.data()[2 * count_ + p] = z;
      weights_[static_cast<std::size_t>(p)] = counts ? rule.weights[ring] * (2.0 * std::numbers::pi / azimuths_) : 0.0;
    }
    harmonics::harmonics_kernels().evaluate(math::basis_constants(), key.bands, axes.data(), count_, basis_.data());
  }

  static std::shared_ptr<const ProductPoints> get(const PointsKey& key) {
    static auto& cache = *new math::TableCache<PointsKey, ProductPoints>(kProductBytes);
    return cache.get(key, [&] { return std::make_shared<const ProductPoints>(key); });
  }

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const std::vector<double>& weights() const noexcept { return weights_; }
  [[nodiscard]] const double* basis() const noexcept { return basis_.data(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return sizeof *this + 8 * weights_.size() + basis_.bytes(); }

 private:
  static constexpr std::size_t kProductBytes = std::size_t{4} << 20U;  ///< two of the largest tables

  int azimuths_;
  int count_;
  std::vector<double> weights_;
  platform::AlignedBuffer<double> basis_;
};

}  // namespace

// c(l, m) = Int a b Y(l, m): a polynomial of degree D = (bands of a - 1) + (of b - 1) + (of the result - 1) in the
// direction. Both functions are summed in the same way, so that a b and b a have the same bits.
SphericalHarmonics product(const SphericalHarmonics& a, const SphericalHarmonics& b, int bands) {
  const platform::FloatingPointScope floating_point;
  if (bands < 0 || bands > kMaximumBands) {
    throw Error(ErrorCode::invalid_argument, "a product of " + std::to_string(bands) + " bands; 1 to " +
                                                 std::to_string(kMaximumBands) + " are possible, 0 for all there are");
  }
  const int limit = a.bands() + b.bands() - 1;
  const int wanted = bands == 0 ? std::min(limit, kMaximumBands) : bands;
  SphericalHarmonics result(wanted);
  const int integrated = std::min(wanted, limit);
  const auto points =
      ProductPoints::get({a.bands() + b.bands() + integrated - 3, std::max({a.bands(), b.bands(), integrated})});
  const int count = points->count();
  const harmonics::HarmonicsKernels& kernels = harmonics::harmonics_kernels();
  platform::AlignedBuffer<double> room(static_cast<std::size_t>(6 * count));
  double* const first = room.data();
  double* const second = first + std::ptrdiff_t{3} * count;
  const auto functions = [](const SphericalHarmonics& of) { return static_cast<int>(of.coefficients().size()); };
  kernels.sum(&a.coefficients()[0].x, functions(a), points->basis(), count, first);
  kernels.sum(&b.coefficients()[0].x, functions(b), points->basis(), count, second);
  for (int c = 0; c < 3; ++c) {
    for (int p = 0; p < count; ++p) {
      first[c * count + p] =
          points->weights()[static_cast<std::size_t>(p)] * (first[c * count + p] * second[c * count + p]);
    }
  }
  kernels.integrate(first, points->basis(), integrated * integrated, count, &result.coefficients()[0].x);
  return result;
}

}  // namespace welkin
