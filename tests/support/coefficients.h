// Comparing numbers and spherical harmonics.
#pragma once

#include "support/catch.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

/// Whether two numbers differ by no more than `relative` times the second.
inline bool close(double found, double wanted, double relative = 1e-12) {
  return std::abs(found - wanted) <= relative * std::abs(wanted);
}

/// |c| over all coefficients and channels.
inline double norm(const SphericalHarmonics& c) {
  double sum = 0.0;
  for (const glm::dvec3& value : c.coefficients()) sum += glm::dot(value, value);
  return std::sqrt(sum);
}

/// |a - truth| / |truth|.
inline double relative_error(const SphericalHarmonics& a, const SphericalHarmonics& truth) {
  double sum = 0.0;
  for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
    const glm::dvec3 difference = a.coefficients()[k] - truth.coefficients()[k];
    sum += glm::dot(difference, difference);
  }
  return std::sqrt(sum) / norm(truth);
}

/// Every coefficient equal to the last bit; -0 is not 0.
inline bool same_bits(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  if (a.bands() != b.bands()) return false;
  for (std::size_t k = 0; k < a.coefficients().size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const double left = a.coefficients()[k][c];
      const double right = b.coefficients()[k][c];
      if (std::bit_cast<std::uint64_t>(left) != std::bit_cast<std::uint64_t>(right)) return false;
    }
  }
  return true;
}

}  // namespace welkin::test
