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

std::vector<double> compute_spectrum(double alpha, int bands) {
  std::vector<double> sums = moments(make_rule(alpha, std::max(bands, 8)), bands);
  const double whole = sums[0];
  for (double& sum : sums) sum /= whole;
  return sums;
}

struct Key {
  double alpha;
  int bands;
  bool operator==(const Key&) const = default;
};

struct Table {
  std::vector<double> values;
  [[nodiscard]] std::size_t bytes() const { return values.size() * sizeof(double); }
};

math::TableCache<Key, Table>& cache() {
  static auto& tables = *new math::TableCache<Key, Table>(kCachedBytes);  // never destroyed
  return tables;
}

}  // namespace

double lobe(double cosine, double alpha) noexcept { return cosine > 0.0 ? lobe_of_distance(1.0 - cosine, alpha) : 0.0; }

// 2 pi Int_0^1 k dx with t = (1 - alpha^2) / (2 alpha^2): 2 / alpha^2 (t - ln(1 + t)) / t^2.
double lobe_integral(double alpha) noexcept {
  const double square = alpha * alpha;
  const double t = (1.0 - square) / (2.0 * square);
  if (t > 0.05) return 2.0 / square * (t - math::logarithm(1.0 + t)) / (t * t);
  double series = 0.0;  // 1/2 - t/3 + t^2/4 - ...
  for (int k = 14; k >= 2; --k) series = 1.0 / k - t * series;
  return 2.0 / square * series;
}

std::vector<double> lobe_spectrum(double alpha, int bands) {
  return cache()
      .get({alpha, bands}, [&] { return std::make_shared<const Table>(Table{compute_spectrum(alpha, bands)}); })
      ->values;
}

std::vector<double> zonal_moments(std::vector<double> distances, std::vector<double> weights, int bands) {
  Rule rule{std::move(distances), std::move(weights)};
  fill_block(rule);
  return moments(rule, bands);
}

// The whole lobe's without the near part's, which a few panels have.
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

double reach_for(double rms_error, double maximum_error) noexcept {
  constexpr double kReach = 9.25;  // for rms 1e-3 and maximum 1e-2
  const double stricter = std::min(rms_error / 1e-3, maximum_error / 1e-2);
  return std::max(2.0, kReach - math::logarithm(std::clamp(stricter, 1e-6, 1e3)));
}

}  // namespace welkin::reflections
