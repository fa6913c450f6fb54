// Comparisons of numbers and spherical harmonics.
#pragma once

#include <limits>

#include "support/catch.h"
#include "support/same_bits.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

/// Whether two numbers differ by at most `relative` times the second.
inline bool close(double found, double wanted, double relative = 1e-12) {
  return std::abs(found - wanted) <= relative * std::abs(wanted);
}

/// Returns the norm of the difference over all coefficients and channels from band `first_band` on, infinity where `a`
/// has another number of bands.
inline double distance(const SphericalHarmonics& a, const SphericalHarmonics& truth, int first_band = 0) {
  if (a.bands() != truth.bands()) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t k = SphericalHarmonics::index(first_band, -first_band); k < truth.coefficients().size(); ++k) {
    const glm::dvec3 difference = a.coefficients()[k] - truth.coefficients()[k];
    sum += glm::dot(difference, difference);
  }
  return std::sqrt(sum);
}

/// Returns the norm over all coefficients and channels from band `first_band` on.
inline double norm(const SphericalHarmonics& c, int first_band = 0) {
  return distance(c, SphericalHarmonics(c.bands()), first_band);
}

/// Returns the norm of the difference relative to that of the second argument, or 0 if both are zero.
inline double relative_error(const SphericalHarmonics& a, const SphericalHarmonics& truth, int first_band = 0) {
  const double off = distance(a, truth, first_band);
  return off == 0.0 ? 0.0 : off / norm(truth, first_band);
}

/// Whether every coefficient is equal to the last bit; -0 is not 0.
inline bool same_bits(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  return same_bytes(a.coefficients(), b.coefficients());
}

}  // namespace welkin::test
