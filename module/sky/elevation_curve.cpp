#include "sky/elevation_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/elementary.h"

namespace welkin::sky {
namespace {

/// w: at the horizon 256 nodes of both halves are 0.05 degrees apart, at 45 degrees 0.8.
constexpr double kWidth = 0.005;

/// The first of the five nodes that a derivative looks at.
int first_of_five(int node, int nodes) { return std::clamp(node - 2, 0, nodes - 5); }

/// The derivative at a node of the polynomial through the five nearest, which are a step apart.
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
