#include "sky/sky_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "math/direction.h"
#include "math/quadrature.h"

namespace welkin::sky {

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
