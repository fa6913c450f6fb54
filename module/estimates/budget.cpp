#include "estimates/budget.h"

#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "welkin/error.h"

namespace welkin::estimates {
namespace {

constexpr double kLeastBudget = 1e-6;  ///< what float arithmetic leaves

}  // namespace

void check_budget(const ErrorBudget& budget) {
  if (budget.relative >= kLeastBudget && budget.relative <= 1.0) return;
  throw Error(ErrorCode::invalid_argument, "the error budget is " + std::to_string(budget.relative) +
                                               "; it is a share of the result, from 1e-6 to 1 (0.01 is 1 %)");
}

double relative_difference(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  double difference = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < b.coefficients().size(); ++k) {
    const glm::dvec3 off = a.coefficients()[k] - b.coefficients()[k];
    difference += glm::dot(off, off);
    whole += glm::dot(b.coefficients()[k], b.coefficients()[k]);
  }
  if (difference == 0.0) return 0.0;
  return whole > 0.0 ? std::sqrt(difference / whole) : std::numeric_limits<double>::infinity();
}

}  // namespace welkin::estimates
