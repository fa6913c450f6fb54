#include "math/basis.h"

#include <cmath>
#include <numbers>

namespace welkin::math {
namespace {

BasisRecurrence make_recurrence() noexcept {
  BasisRecurrence recurrence{};
  double start_squared = 1.0 / (4.0 * std::numbers::pi);
  for (int m = 0; m < kRecurrenceBands; ++m) {
    const double order = m;
    // q(m, m)^2 = q(m - 1, m - 1)^2 (2 m + 1) / (2 m), and 2 - [m = 0] once: see basis.h. Roots of exact quotients keep
    // each constant within a rounding or two.
    if (m > 0) start_squared *= (2.0 * order + 1.0) / (2.0 * order);
    if (m == 1) start_squared *= 2.0;
    recurrence.start[m] = std::sqrt(start_squared);
    for (int band = m + 1; band < kRecurrenceBands; ++band) {
      const double l = band;
      const double below = l * l - order * order;
      recurrence.a[m][band] = std::sqrt((4.0 * l * l - 1.0) / below);
      // At l = m + 1 the numerator is zero and so is the term: q(m - 1, m) does not exist.
      recurrence.b[m][band] =
          std::sqrt((2.0 * l + 1.0) * ((l - 1.0) * (l - 1.0) - order * order) / ((2.0 * l - 3.0) * below));
    }
  }
  return recurrence;
}

}  // namespace

double sum_of_degrees(const std::vector<double>& factors, double x) noexcept {
  double sum = 0.0;
  for_each_legendre(x, factors.size(), [&](std::size_t l, double legendre) {
    sum += (2.0 * static_cast<double>(l) + 1.0) * factors[l] * legendre;
  });
  return sum / (4.0 * std::numbers::pi);
}

const BasisRecurrence& basis_constants() noexcept {
  static const BasisRecurrence recurrence = make_recurrence();
  return recurrence;
}

void evaluate_basis(double x, double y, double z, int bands, double* values) noexcept {
  for_each_basis_value(basis_constants(), x, y, z, 1.0, bands,
                       [values](int index, double value) { values[index] = value; });
}

}  // namespace welkin::math
