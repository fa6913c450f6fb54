#include "sky/sky_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "math/direction.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "platform/text.h"
#include "sky/sky_kernels.h"

namespace welkin::sky {
namespace {

/// Below, a float may lose digits.
constexpr double kMinBrightness = 1e-30;
constexpr double kLargestFall = 0.01;
/// Where light goes out within a step, a cubic swings beyond its nodes: limits relative to the two nearest.
constexpr double kMinSwing = 0.9;
constexpr double kMaxSwing = 1.1;

}  // namespace

void limit_decay(std::span<double> nodes) noexcept {
  for (std::size_t k = 1; k < nodes.size(); ++k) nodes[k] = std::max(nodes[k], kLargestFall * nodes[k - 1]);
  for (std::size_t k = nodes.size(); k-- > 1;) nodes[k - 1] = std::max(nodes[k - 1], kLargestFall * nodes[k]);
}

// A cubic of the logarithm is exact for exponentials of cubics, and follows light that falls by decades, where a cubic
// of the light itself may swing below 0. A straight line over 1/32 of a step that changes it by a factor e exceeds the
// exponential by (1/32)^2 / 8 = 1.2e-4 in the middle.
std::vector<float> resample_log_cubic(std::span<const double> nodes) {
  const auto count = static_cast<int>(nodes.size());
  std::vector<double> logarithms;
  for (const double value : nodes) logarithms.push_back(value > kMinBrightness ? math::logarithm(value) : 0.0);
  std::vector<float> steps;
  for (int k = 0; k <= (count - 1) * kSunSteps; ++k) {
    const int node = std::min(k / kSunSteps, count - 2);
    const double part = static_cast<double>(k - node * kSunSteps) / kSunSteps;
    const Cubic cubic = cubic_at(node + part, count);
    double logarithm = 0.0;
    bool positive = true;
    for (int i = 0; i < std::min(count, 4); ++i) {
      const auto at = static_cast<std::size_t>(cubic.first + i);
      positive = positive && nodes[at] > kMinBrightness;
      logarithm += cubic.weights[i] * logarithms[at];
    }
    const double low = nodes[static_cast<std::size_t>(node)];
    const double high = nodes[static_cast<std::size_t>(node) + 1];
    if (!positive) {
      const auto at = static_cast<std::size_t>(node);
      logarithm = logarithms[at] + part * (logarithms[at + 1] - logarithms[at]);
      positive = low > kMinBrightness && high > kMinBrightness;
    }
    const double value = positive ? math::exponential(logarithm) : low + part * (high - low);
    const double limited = std::clamp(value, kMinSwing * std::min(low, high), kMaxSwing * std::max(low, high));
    steps.push_back(limited > kMinBrightness ? static_cast<float>(limited) : 0.0F);
  }
  return steps;
}

// Int f(mu) dmu over the three parts, mu = horizon - (1 + horizon) t^2 with dmu = (1 + horizon) 2 t dt, mu = horizon
// (1 - t), and mu = t^2 with dmu = 2 t dt; the weights add up to 2. Along rays to the ground the length is
// -r mu - sqrt((r mu)^2 - rho^2), in which the root goes as sqrt(horizon - mu): in mu its slope is infinite at the
// horizon, in t it is smooth. Upwards t^2 puts nodes close to the horizontal, where the length of a ray through the air
// changes fastest with mu.
DirectionRule direction_rule(double horizon) {
  DirectionRule rule;
  std::size_t at = 0;
  const auto add = [&](int order, const auto& place) {
    const math::GaussRule gauss = math::gauss_legendre(order);
    for (int k = 0; k < order; ++k, ++at) place(0.5 + 0.5 * gauss.nodes[k], 0.5 * gauss.weights[k]);
  };
  const auto put = [&](double cosine, double weight) {
    rule.cosines[at] = cosine;
    rule.weights[at] = weight;
  };
  add(DirectionRule::kGroundNodes, [&](double t, double w) {
    put(std::max(-1.0, horizon - (1.0 + horizon) * t * t), (1.0 + horizon) * 2.0 * t * w);
  });
  add(DirectionRule::kLowNodes, [&](double t, double w) { put(horizon * (1.0 - t), -horizon * w); });
  add(DirectionRule::kUpperNodes, [&](double t, double w) { put(t * t, 2.0 * t * w); });
  return rule;
}

void check_altitude(double altitude_m) { platform::require_between("the altitude in metres", altitude_m, 0.0, 1e9); }

SunAngles sun_angles(const glm::dvec3& sun) {
  const glm::dvec3 scaled = math::rescaled_direction(sun, "the sun's direction");  // no square overflows or vanishes
  const double across = std::sqrt(scaled.x * scaled.x + scaled.z * scaled.z);
  const double length = std::sqrt(across * across + scaled.y * scaled.y);
  SunAngles angles{.zenith_cosine = scaled.y / length, .zenith_sine = across / length};
  if (across > 0.0) {
    angles.azimuth_cosine = scaled.z / across;
    angles.azimuth_sine = scaled.x / across;
  }
  return angles;
}

}  // namespace welkin::sky
