// Sums, multiples and cuts of coefficients.
#include <algorithm>

#include "welkin/harmonic_transforms.h"

namespace welkin {
namespace {

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

SphericalHarmonics add(const SphericalHarmonics& a, const SphericalHarmonics& b) { return combined(a, 1.0, b, 1.0); }

SphericalHarmonics scale(const SphericalHarmonics& a, const glm::dvec3& factor) {
  SphericalHarmonics scaled = a;
  for (glm::dvec3& value : scaled.coefficients()) value *= factor;
  return scaled;
}

SphericalHarmonics lerp(const SphericalHarmonics& a, const SphericalHarmonics& b, double t) {
  return combined(a, 1.0 - t, b, t);
}

SphericalHarmonics with_bands(const SphericalHarmonics& harmonics, int bands) {
  SphericalHarmonics result(bands);
  const std::size_t kept = std::min(result.coefficients().size(), harmonics.coefficients().size());
  std::copy_n(harmonics.coefficients().begin(), kept, result.coefficients().begin());
  return result;
}

}  // namespace welkin
