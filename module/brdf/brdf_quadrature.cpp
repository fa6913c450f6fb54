#include "brdf/brdf_quadrature.h"

#include <cstddef>
#include <numbers>

#include "math/elementary.h"
#include "math/quadrature.h"

namespace welkin::brdf {
namespace {

struct Node {
  double place;  ///< in (0, 1)
  double weight;
};

/// Gauss's rule on [0, 1].
template <class Use>
void for_each_node(int order, const Use& use) {
  const math::GaussRule rule = math::gauss_legendre(order);
  for (int i = 0; i < order; ++i) use(Node{0.5 + 0.5 * rule.nodes[i], 0.5 * rule.weights[i]});
}

}  // namespace

AlbedoQuadrature::AlbedoQuadrature(const AlbedoOrders& orders) {
  const auto side = [&](int order, double sign) {
    for_each_node(order, [&](const Node& node) {
      // From 90 degrees on by a quarter turn times place^2.
      azimuth_cosines_.push_back(
          static_cast<float>(sign * math::sine_cosine_of_turns(0.25 * node.place * node.place).sine));
      azimuth_weights_.push_back(static_cast<float>(std::numbers::pi * node.place * node.weight));
    });
  };
  side(orders.towards, 1.0);
  side(orders.away, -1.0);
}

AlbedoQuadrature AlbedoQuadrature::even(const AlbedoOrders& orders) {
  AlbedoQuadrature made(orders);
  for_each_node(orders.radii, [&](const Node& node) {
    made.radius_places_.push_back(static_cast<float>(node.place));
    made.radius_weights_.push_back(static_cast<float>(node.weight));
  });
  return made;
}

AlbedoQuadrature AlbedoQuadrature::thinning(const AlbedoOrders& orders) {
  AlbedoQuadrature made(orders);
  for_each_node(orders.radii, [&](const Node& node) {
    const double left = 1.0 - node.place;
    made.radius_places_.push_back(static_cast<float>(1.0 - left * left));
    made.radius_weights_.push_back(static_cast<float>(2.0 * left * node.weight));
  });
  return made;
}

AlbedoRule AlbedoQuadrature::rule() const noexcept {
  return {static_cast<int>(azimuth_cosines_.size()), azimuth_cosines_.data(), azimuth_weights_.data(),
          static_cast<int>(radius_places_.size()),   radius_places_.data(),   radius_weights_.data()};
}

AlbedoRules::AlbedoRules()
    : ggx_{AlbedoQuadrature::even({10, 10, 20}), AlbedoQuadrature::even({10, 10, 16}),
           AlbedoQuadrature::even({10, 10, 14}), AlbedoQuadrature::even({8, 8, 12})},
      sheen_{AlbedoQuadrature::thinning({14, 8, 16}), AlbedoQuadrature::thinning({12, 8, 14}),
             AlbedoQuadrature::thinning({8, 6, 12})} {}

AlbedoRule AlbedoRules::ggx(double roughness, double least_cosine) const noexcept {
  if (roughness < 0.35) return ggx_[0].rule();
  if (roughness < 0.5) return ggx_[1].rule();
  return ggx_[least_cosine < 0.02 ? 2 : 3].rule();
}

AlbedoRule AlbedoRules::sheen(double roughness) const noexcept {
  if (roughness < 0.3) return sheen_[0].rule();
  return sheen_[roughness < 0.5 ? 1 : 2].rule();
}

}  // namespace welkin::brdf
