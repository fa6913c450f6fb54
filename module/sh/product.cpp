// The product of two functions on the sphere, by a quadrature that is exact for its band limit.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sh/basis.h"
#include "tables/gauss_legendre.h"
#include "tables/trigonometry.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"

namespace welkin {
namespace {

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
  if (bands < 0 || bands > kMaximumBands) {
    throw Error(ErrorCode::invalid_argument, "a product of " + std::to_string(bands) + " bands; 1 to " +
                                                 std::to_string(kMaximumBands) + " are possible, 0 for all there are");
  }
  const int limit = a.bands() + b.bands() - 1;
  const int wanted = bands == 0 ? std::min(limit, kMaximumBands) : bands;
  SphericalHarmonics result(std::min(wanted, limit));

  const int degree = a.bands() + b.bands() + result.bands() - 3;
  const simd::GaussRule rule = tables::gauss_legendre(degree / 2 + 1);
  const int azimuths = degree + 1;
  const int basis_bands = std::max({a.bands(), b.bands(), result.bands()});
  std::vector<double> basis(static_cast<std::size_t>(basis_bands * basis_bands));
  for (int i = 0; i < rule.order; ++i) {
    const double z = rule.nodes[i];
    const double ring = std::sqrt((1.0 - z) * (1.0 + z));
    const double weight = rule.weights[i] * (2.0 * std::numbers::pi / azimuths);
    for (int k = 0; k < azimuths; ++k) {
      const tables::SineCosine azimuth = tables::sine_cosine_of_turns(static_cast<double>(k) / azimuths);
      sh::evaluate_basis(ring * azimuth.cosine, ring * azimuth.sine, z, basis_bands, basis.data());
      const glm::dvec3 value = weight * (sum_of(a, basis) * sum_of(b, basis));
      std::size_t at = 0;
      for (glm::dvec3& coefficient : result.coefficients()) coefficient += value * basis[at++];
    }
  }
  return with_bands(result, wanted);
}

}  // namespace welkin
