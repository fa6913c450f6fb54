#include "sky/elevation_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/elementary.h"

namespace welkin::sky {
namespace {

/// w: at the horizon 256 nodes of both halves are 0.045 degrees apart, at 45 degrees 1.1.
constexpr double kWidth = 0.005;

/// The first of the five nodes that a derivative looks at.
int first_of_five(int node, int nodes) { return std::clamp(node - 2, 0, nodes - 5); }

/// The derivative at a node of the polynomial through the five nearest, which are a step apart.
/// Weights over 12 of the nodes' values: derivatives of Lagrange's polynomials of degree four at node 0, 1, 2, 3 or 4
/// of the five. Exact for polynomials of degree four; the middle row is the central difference
/// (f_-2 - 8 f_-1 + 8 f_1 - f_2) / 12.
template <class Value>
double derivative(const Value& value, int node, int nodes) {
  constexpr double weights[5][5] = {{-25.0, 48.0, -36.0, 16.0, -3.0},
                                    {-3.0, -10.0, 18.0, -6.0, 1.0},
                                    {1.0, -8.0, 0.0, 8.0, -1.0},
                                    {-1.0, 6.0, -18.0, 10.0, 3.0},
                                    {3.0, -16.0, 36.0, -48.0, 25.0}};
  const int first = first_of_five(node, nodes);
  double sum = 0.0;
  for (int k = 0; k < 5; ++k) {
    const double weight = weights[node - first][k];
    if (weight != 0.0) sum += weight * value(first + k);
  }
  return sum / 12.0;
}

/// Whether `value` can be divided by and has a logarithm at all nodes that `derivative` looks at.
template <class Value>
bool positive_around(const Value& value, int node, int nodes) {
  const int first = first_of_five(node, nodes);
  for (int k = first; k < first + 5; ++k) {
    if (!(value(k) >= std::numeric_limits<double>::min())) return false;
  }
  return true;
}

}  // namespace

CurveAxis::CurveAxis(int count, double lowest, double horizon) noexcept
    : count_(count), horizon_(horizon), first_(coordinate(lowest)), step_((coordinate(1.0) - first_) / (count - 1)) {}

// t^2 = x^2 / (w + sqrt(w^2 + x^2)) = sqrt(w^2 + x^2) - w, in the form that does not cancel. The inverse:
// t^2 + w = sqrt(w^2 + x^2), x^2 = t^4 + 2 w t^2. t ~ x / sqrt(2 w) for |x| below w, sqrt(x) beyond it.
double CurveAxis::coordinate(double sine) const noexcept {
  const double x = sine - horizon_;
  return x / std::sqrt(kWidth + std::sqrt(kWidth * kWidth + x * x));
}

double CurveAxis::sine(int node) const noexcept {
  if (node == count_ - 1) return 1.0;
  const double t = first_ + step_ * node;
  return std::clamp(horizon_ + t * std::sqrt(t * t + 2.0 * kWidth), -1.0, 1.0);
}

CurveAxis::Place CurveAxis::place(double sine) const noexcept {
  const double position = std::clamp((coordinate(sine) - first_) / step_, 0.0, static_cast<double>(count_ - 1));
  const int interval = std::min(static_cast<int>(position), count_ - 2);
  return {interval, position - interval};
}

// Hermite's basis (1 - t)^2 (1 + 2 t), (1 - t)^2 t, t^2 (3 - 2 t) and -t^2 (1 - t): value 1 or slope 1 at one end, 0
// else.
void CurveValues::at(const CurveAxis::Place& place, double* results) const noexcept {
  const double t = place.part;
  const double rest = 1.0 - t;
  const double first_value = rest * rest * (1.0 + 2.0 * t);
  const double first_slope = rest * rest * t;
  const double second_value = t * t * (3.0 - 2.0 * t);
  const double second_slope = -t * t * rest;
  const double* const first = values.data() + static_cast<std::size_t>(place.interval) * functions * 2;
  const double* const second = first + functions * 2;
  for (std::size_t i = 0; i < functions; ++i) {
    results[i] = (first_value * first[2 * i] + first_slope * first[2 * i + 1]) +
                 (second_value * second[2 * i] + second_slope * second[2 * i + 1]);
  }
}

// f' = f (log f)'. The limit: in Bernstein's basis the cubic has the coefficients f_0, f_0 + s_0 / 3, f_1 - s_1 / 3 and
// f_1, and it is not negative if they are not: s_0 >= -3 f_0 and s_1 <= 3 f_1. A node is the end of one cubic and the
// start of the next, so that its slope is held to both.
void set_slopes_of_positive(CurveValues& curve, int nodes, std::size_t function) {
  const auto value = [&](int node) { return curve.value(node, function); };
  const auto logarithm = [&](int node) { return math::logarithm(value(node)); };
  for (int node = 0; node < nodes; ++node) {
    const double slope = positive_around(value, node, nodes) ? value(node) * derivative(logarithm, node, nodes)
                                                             : derivative(value, node, nodes);
    const double most = 3.0 * std::max(value(node), 0.0);
    curve.slope(node, function) = std::clamp(slope, -most, most);
  }
}

// f = ratio x leader: f' = leader ratio' + ratio leader'. The ratio is smooth where both fall by decades.
void set_slopes_by_ratio(CurveValues& curve, int nodes, std::size_t function, std::size_t leader) {
  const auto value = [&](int node) { return curve.value(node, function); };
  const auto leading = [&](int node) { return curve.value(node, leader); };
  const auto ratio = [&](int node) { return value(node) / leading(node); };
  for (int node = 0; node < nodes; ++node) {
    if (positive_around(leading, node, nodes)) {
      curve.slope(node, function) =
          leading(node) * derivative(ratio, node, nodes) + ratio(node) * curve.slope(node, leader);
    } else {
      curve.slope(node, function) = value(node) == 0.0 ? 0.0 : derivative(value, node, nodes);
    }
  }
}

}  // namespace welkin::sky
