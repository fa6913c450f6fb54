#include "math/quadrature.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>

#include "math/elementary.h"
#include "platform/float_environment.h"

namespace welkin::math {
namespace {

struct Rule {
  std::array<double, kMaximumGaussOrder> nodes{};
  std::array<double, kMaximumGaussOrder> weights{};
};

struct Legendre {
  double value;
  double derivative;
};

/// P_n(x) and its derivative by Bonnet's recurrence, |x| < 1.
Legendre legendre(int n, double x) {
  double before = 1.0;
  double here = x;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k;
    before = here;
    here = next;
  }
  // (1 - x^2) P(n)' = n (P(n - 1) - x P(n)).
  return {here, n * (x * here - before) / (x * x - 1.0)};
}

/// Writes `order` >= 2 nodes and weights.
void make_rule(int order, double* nodes, double* weights) {
  const auto n = static_cast<std::size_t>(order);
  for (std::size_t i = 0; i < (n + 1) / 2; ++i) {
    // Tricomi's start, then Newton; five steps are more than double precision needs.
    // x_i = cos(pi (i + 3/4) / (n + 1/2)), i from 0, off by O(n^-2); each of Newton's steps squares the error.
    double x = sine_cosine_of_turns((static_cast<double>(i) + 0.75) / (2.0 * order + 1.0)).cosine;
    if (2 * i + 1 == n) x = 0.0;
    for (int step = 0; step < 6 && x != 0.0; ++step) {
      const Legendre p = legendre(order, x);
      x -= p.value / p.derivative;
    }
    // w = 2 / ((1 - x^2) P'(x)^2) (Abramowitz and Stegun 25.4.29).
    const double derivative = legendre(order, x).derivative;
    const double weight = 2.0 / ((1.0 - x * x) * derivative * derivative);
    nodes[i] = -x;
    nodes[n - 1 - i] = x;
    weights[i] = weights[n - 1 - i] = weight;
  }
}

}  // namespace

GaussRule gauss_legendre(int order) {
  static std::array<Rule, kMaximumGaussOrder + 1> rules;
  static std::array<std::once_flag, kMaximumGaussOrder + 1> made;
  Rule& rule = rules[static_cast<std::size_t>(order)];
  std::call_once(made[static_cast<std::size_t>(order)], [&] {
    const platform::FloatingPointScope floating_point;  // the rule outlives the call
    rule.weights[0] = 2.0;                              // Newton's recurrence starts at two points
    if (order > 1) make_rule(order, rule.nodes.data(), rule.weights.data());
  });
  return {order, rule.nodes.data(), rule.weights.data()};
}

GaussRule texel_rule(int size) {
  // rho^(-2 order), rho = size + sqrt(size^2 + 1) (quadrature.h), is 4e-22 for 1, 9e-21 for 2, 1e-19 for 3, 5e-20 for
  // 8, 9e-19 for 32 and 3e-15 for 129.
  if (size == 1) return gauss_legendre(28);
  if (size == 2) return gauss_legendre(16);
  if (size < 8) return gauss_legendre(12);
  if (size < 32) return gauss_legendre(8);
  if (size <= kLargestIntegratedFace) return gauss_legendre(5);
  return gauss_legendre(3);
}

GaussNodes gauss_nodes(int order) {
  GaussNodes rule{std::vector<double>(static_cast<std::size_t>(order), 0.0),
                  std::vector<double>(static_cast<std::size_t>(order), 2.0)};
  if (order > 1) make_rule(order, rule.nodes.data(), rule.weights.data());
  return rule;
}

double rectangle_solid_angle(double u, double v, double u_half, double v_half, const GaussRule& rule) noexcept {
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

}  // namespace welkin::math
