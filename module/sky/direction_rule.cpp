#include "sky/direction_rule.h"

#include <algorithm>
#include <cstddef>

#include "tables/gauss_legendre.h"

namespace welkin::sky {

DirectionRule direction_rule(double horizon) {
  DirectionRule rule;
  std::size_t at = 0;
  const auto add = [&](int order, const auto& place) {
    const simd::GaussRule gauss = tables::gauss_legendre(order);
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

}  // namespace welkin::sky
