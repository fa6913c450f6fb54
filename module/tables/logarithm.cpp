#include "tables/logarithm.h"

#include <cmath>
#include <numbers>

namespace welkin::tables {

// x = 2^e m with m from sqrt(1/2) to sqrt(2); ln m = 2 artanh z, z = (m - 1) / (m + 1), |z| < 0.1716: twelve terms of
// its series leave out less than 1e-18.
double logarithm(double x) noexcept {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // takes the number apart: exact
  if (mantissa < std::numbers::sqrt2 / 2.0) {
    mantissa *= 2.0;
    --exponent;
  }
  const double z = (mantissa - 1.0) / (mantissa + 1.0);
  const double square = z * z;
  double series = 0.0;
  for (int k = 23; k >= 3; k -= 2) series = (series + 1.0 / k) * square;
  return exponent * std::numbers::ln2 + 2.0 * (z + z * series);
}

}  // namespace welkin::tables
