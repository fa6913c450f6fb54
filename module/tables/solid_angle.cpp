#include "tables/solid_angle.h"

#include <cmath>

namespace welkin::tables {

double rectangle_solid_angle(double u, double v, double u_half, double v_half, const simd::GaussRule& rule) noexcept {
  double sum = 0.0;
  for (int j = 0; j < rule.order; ++j) {
    const double v_node = v + v_half * rule.nodes[j];
    for (int i = 0; i < rule.order; ++i) {
      const double u_node = u + u_half * rule.nodes[i];
      const double q = 1.0 / (1.0 + u_node * u_node + v_node * v_node);
      sum += rule.weights[i] * rule.weights[j] * q * std::sqrt(q);
    }
  }
  return sum * u_half * v_half;
}

}  // namespace welkin::tables
