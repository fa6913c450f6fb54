#include "reflections/lobe.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <utility>

#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "reflections/lobe_kernels.h"
#include "reflections/near_kernels.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kOrder = 20;  ///< points a panel
constexpr std::size_t kCachedBytes = 4U << 20U;

/// c D sin-free: with x = 1 - c, half vector squared is 1 - x / 2, so that D = alpha^2 / (pi (alpha^2 + x s)^2),
/// s = (1 - alpha^2) / 2.
double lobe_of_distance(double x, double alpha) noexcept {
  const double square = alpha * alpha;
  const double width = square + x * (0.5 * (1.0 - square));
  return (1.0 - x) * square / (kPi * width * width);
}

/// Nodes in x and weights (times the lobe) of Int_0^1 k(1 - x) f(1 - x) dx, where f is a polynomial of degree below
/// `bands`.
struct Rule {
  std::vector<double> distance;
  std::vector<double> weight;
};

/// Nodes without weight, up to a whole block.
void fill_block(Rule& rule) {
  while (rule.distance.size() % kMomentLanes != 0) {
    rule.distance.push_back(0.0);
    rule.weight.push_back(0.0);
  }
}

/// Up to s = `end`. In s = sqrt(x / 2) = sin(theta / 2), dx = 4 s ds, the lobe has its poles at s = +- i alpha / sqrt(1
/// - alpha^2) and P_l oscillates evenly. So panels double in width from alpha on, and none is wider than 28 radians of
/// the highest band's phase, which moves at most 2.83 l a unit of s: (e 14 / (4 x 20))^40 = 1e-13 of it is lost.
Rule make_rule(double alpha, int bands, double end = std::numbers::sqrt2 / 2.0) {
  const math::GaussRule gauss = math::gauss_legendre(kOrder);
  const double widest = 28.0 / (2.83 * bands);
  Rule rule;
  for (double from = 0.0; from < end;) {
    double to = from + std::min(std::max(from, alpha), widest);
    if (to > end - 1e-3 * (to - from)) to = end;
    const double half = 0.5 * (to - from);
    for (int i = 0; i < kOrder; ++i) {
      const double s = from + half + half * gauss.nodes[i];
      const double x = 2.0 * s * s;
      rule.distance.push_back(x);
      rule.weight.push_back(half * gauss.weights[i] * 4.0 * s * lobe_of_distance(x, alpha));
    }
    from = to;
  }
  fill_block(rule);
  return rule;
}

/// Int k P_l over what the rule integrates, for l < bands.
std::vector<double> moments(const Rule& rule, int bands) {
  const auto count = static_cast<std::size_t>(bands);
  std::vector<double> factors;
  for (int l = 0; l < bands; ++l) factors.insert(factors.end(), {l / (l + 1.0), (2.0 * l + 1.0) / (l + 1.0)});
  std::vector<double> lanes(kMomentLanes * count, 0.0);
  lobe_kernels().sum_moments({rule.distance.data(), rule.weight.data(),
                              static_cast<int>(rule.distance.size()) / kMomentLanes, factors.data(), bands},
                             lanes.data());
  std::vector<double> sums;
  for (const double* lane = lanes.data(); sums.size() < count; lane += kMomentLanes)
    sums.push_back(((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7])));
  return sums;
}

// With a = 1 + 2 alpha^2 / (1 - alpha^2) the lobe is c / (a - c)^2 but for a factor, and Int c P_l / (a - c)^2 = a B_l
// - A_l with A_l = Int P_l / (a - c) and B_l = Int P_l / (a - c)^2, from c = 0 to 1. By the recurrence of P_l
//   (l + 1) A_(l + 1) - (2 l + 1) a A_l + l A_(l - 1) = -(2 l + 1) Int P_l,
// and B the same with A_l for Int P_l. Solutions grow or fall like exp(+-2 alpha l): from A_0 = ln(a / (a - 1)), B_0 =
// 1 / (a - 1) - 1 / a and 0 far beyond the bands, elimination gives the falling ones (F. W. J. Olver, "Numerical
// solution of second-order linear difference equations", Journal of Research of the NBS 71B, 1967).

constexpr double kBeyond = 10.0;  ///< over alpha: degrees beyond the bands, which leave e^-20 of the end's error

/// Returns the solution from `first` on for the right side -(2 l + 1) right_l.
std::vector<double> solve_recurrence(double a, double first, const std::vector<double>& right) {
  std::vector<double> factors(right.size(), 0.0);  // x_l = factor_l x_(l + 1) + value_l
  std::vector<double> values(right.size(), 0.0);
  values[0] = first;
  for (std::size_t l = 1; l + 1 < right.size(); ++l) {
    const auto degree = static_cast<double>(l);
    const double scale = 1.0 / ((2.0 * degree + 1.0) * a - degree * factors[l - 1]);
    factors[l] = (degree + 1.0) * scale;
    values[l] = (degree * values[l - 1] + (2.0 * degree + 1.0) * right[l]) * scale;
  }
  for (std::size_t l = right.size() - 1; l-- > 0;) values[l] += factors[l] * values[l + 1];
  return values;
}

/// Returns the first moments of the lobe but for a factor.
std::vector<double> moments_by_recurrence(double alpha, int bands) {
  const double above = 2.0 * alpha * alpha / ((1.0 - alpha) * (1.0 + alpha));  // a - 1
  const double a = 1.0 + above;
  std::vector<double> integrals(static_cast<std::size_t>(bands) + static_cast<std::size_t>(kBeyond / alpha) + 8, 0.0);
  integrals[0] = 1.0;  // Int P_l = (P_(l - 1)(0) - P_(l + 1)(0)) / (2 l + 1)
  double at_0 = 1.0;   // P_(l - 1)(0)
  for (std::size_t l = 1; l < integrals.size(); l += 2) {
    const auto degree = static_cast<double>(l);
    const double next = -at_0 * degree / (degree + 1.0);
    integrals[l] = (at_0 - next) / (2.0 * degree + 1.0);
    at_0 = next;
  }
  const std::vector<double> first = solve_recurrence(a, math::logarithm(a / above), integrals);
  std::vector<double> second = solve_recurrence(a, 1.0 / above - 1.0 / a, first);
  second.resize(static_cast<std::size_t>(bands));
  for (std::size_t l = 0; l < second.size(); ++l) second[l] = a * second[l] - first[l];
  return second;
}

std::vector<double> compute_spectrum(double alpha, int bands) {
  // whichever takes less time; lobes of alpha 1 have no a
  const bool recurrence = bands >= 96 && alpha < 0.9 && kBeyond / alpha <= 12.0 * bands;
  std::vector<double> sums =
      recurrence ? moments_by_recurrence(alpha, bands) : moments(make_rule(alpha, std::max(bands, 8)), bands);
  const double whole = sums[0];
  for (double& sum : sums) sum /= whole;
  return sums;
}

struct Key {
  double alpha;
  int bands;
  bool operator==(const Key&) const = default;
};

}  // namespace

double lobe(double cosine, double alpha) noexcept { return cosine > 0.0 ? lobe_of_distance(1.0 - cosine, alpha) : 0.0; }

// 2 pi Int_0^1 k dx with t = (1 - alpha^2) / (2 alpha^2): 2 / alpha^2 (t - ln(1 + t)) / t^2.
// For with y = t x the lobe is (1 - y / t) / (pi alpha^2 (1 + y)^2), and from y = 0 to t the integral of 1 / (1 + y)^2
// is t / (1 + t), that of y / (1 + y)^2 is ln(1 + t) - t / (1 + t). For small t the difference would cancel: it is
// then summed as a series.
double lobe_integral(double alpha) noexcept {
  const double square = alpha * alpha;
  const double t = (1.0 - square) / (2.0 * square);
  if (t > 0.05) return 2.0 / square * (t - math::logarithm(1.0 + t)) / (t * t);
  double series = 0.0;  // 1/2 - t/3 + t^2/4 - ...
  for (int k = 14; k >= 2; --k) series = 1.0 / k - t * series;
  return 2.0 / square * series;
}

std::vector<double> lobe_spectrum(double alpha, int bands) {
  static auto& cache = *new math::TableCache<Key, math::NumberTable>(kCachedBytes);  // never destroyed
  return cache.get({alpha, bands}, [&] { return math::number_table(compute_spectrum(alpha, bands)); })->values;
}

std::vector<double> zonal_moments(std::vector<double> distances, std::vector<double> weights, int bands) {
  Rule rule{std::move(distances), std::move(weights)};
  fill_block(rule);
  return moments(rule, bands);
}

// The whole lobe's without the near part's, which a few panels have. With x = (q + s^2) / end, s^2 = distance / 2, the
// lobe is proportional to 1 / x^2 and its far part to P(x) within x < 1: the far part's share is x^2 P(x).
std::vector<double> far_spectrum(double alpha, double end, int bands) {
  const double q = alpha * alpha / ((1.0 - alpha) * (1.0 + alpha));
  const double whole = lobe_integral(alpha) / (2.0 * kPi);
  Rule rule = make_rule(alpha, std::max(bands, 8), std::sqrt(end - q));
  for (std::size_t i = 0; i < rule.distance.size(); ++i) {
    const double x = std::min(1.0, (q + 0.5 * rule.distance[i]) / end);
    rule.weight[i] *= (1.0 - x * x * far_polynomial(x)) / whole;
  }
  const std::vector<double> near = moments(rule, bands);
  std::vector<double> far = lobe_spectrum(alpha, bands);
  for (std::size_t l = 0; l < far.size(); ++l) far[l] -= near[l];
  return far;
}

// A spectrum falls like exp(-2 alpha l), so that a bound that is tighter by a factor takes its logarithm more.
double reach_for(double rms, double maximum) noexcept {
  constexpr double kReach = 9.25;  // for rms 1e-3 and maximum 1e-2
  const double stricter = std::min(rms / 1e-3, maximum / 1e-2);
  return std::max(2.0, kReach - math::logarithm(std::clamp(stricter, 1e-6, 1e3)));
}

}  // namespace welkin::reflections
