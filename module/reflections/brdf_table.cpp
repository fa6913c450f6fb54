#include "reflections/brdf_table.h"

#include <cstddef>
#include <numbers>
#include <string>

#include "jobs/control.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
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

AlbedoQuadrature::AlbedoQuadrature(const AlbedoOrders& orders, Radii radii) {
  const auto side = [&](int order, double sign) {
    for_each_node(order, [&](const Node& node) {
      // From 90 degrees on by a quarter turn times place^2, whose differential is pi place dplace. The cosine of that
      // azimuth is the sine of the angle from 90 degrees, with its digits near the edge.
      azimuth_cosines_.push_back(
          static_cast<float>(sign * math::sine_cosine_of_turns(0.25 * node.place * node.place).sine));
      azimuth_weights_.push_back(static_cast<float>(std::numbers::pi * node.place * node.weight));
    });
  };
  side(orders.towards, 1.0);
  side(orders.away, -1.0);
  for_each_node(orders.radii, [&](const Node& node) {
    const bool even = radii == Radii::even;
    // y -> 1 - (1 - y)^2, dy -> 2 (1 - y) dy
    const double left = 1.0 - node.place;
    radius_places_.push_back(static_cast<float>(even ? node.place : 1.0 - left * left));
    radius_weights_.push_back(static_cast<float>(even ? node.weight : 2.0 * left * node.weight));
  });
}

AlbedoRule AlbedoQuadrature::rule() const noexcept {
  return {static_cast<int>(azimuth_cosines_.size()), azimuth_cosines_.data(), azimuth_weights_.data(),
          static_cast<int>(radius_places_.size()),   radius_places_.data(),   radius_weights_.data()};
}

AlbedoRules::AlbedoRules()
    : ggx_{{{{6, 10, 20}, Radii::even}, {{8, 9, 17}, Radii::even}, {{8, 9, 15}, Radii::even}}},
      sheen_{{{{14, 3, 16}, Radii::thinning}, {{10, 6, 13}, Radii::thinning}, {{9, 6, 10}, Radii::thinning}}} {}

AlbedoRule AlbedoRules::of(const std::array<AlbedoQuadrature, 3>& rules, double roughness) noexcept {
  return rules[roughness < 0.25 ? 0 : (roughness < 0.5 ? 1 : 2)].rule();
}

}  // namespace welkin::reflections

namespace welkin {
namespace {

constexpr int kLargestEdge = 4096;
constexpr std::size_t kCacheBytes = std::size_t{32} << 20U;  ///< some 650 tables of 64 x 64, or two of 1024 x 1024

void check_edge(const char* which, int edge) {
  if (edge >= 1 && edge <= kLargestEdge) return;
  throw Error(ErrorCode::invalid_argument, "a BRDF table's " + std::string(which) + " is " + std::to_string(edge) +
                                               "; pass 1 to " + std::to_string(kLargestEdge));
}

}  // namespace

std::size_t reflections::brdf_values(const BrdfTableOptions& options) noexcept {
  return static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height) *
         static_cast<std::size_t>(options.sheen ? 3 : 2);
}

void reflections::check_brdf(const BrdfTableOptions& options) {
  check_edge("width", options.width);
  check_edge("height", options.height);
}

std::shared_ptr<const BrdfTable> reflections::shared_brdf(const BrdfTableOptions& options, const Control& control,
                                                          bool& made) {
  check_brdf(options);
  made = true;
  jobs::throw_if_cancelled(control);
  // What would not be kept is made without the cache, where whoever wants the same waits for it, deaf to its own stop.
  if (reflections::brdf_values(options) * sizeof(float) > kCacheBytes)
    return reflections::integrated_brdf(options, control);
  static auto& cache = *new math::TableCache<BrdfTableOptions, BrdfTable>(kCacheBytes);  // never destroyed
  made = false;
  std::shared_ptr<const BrdfTable> table = cache.get(options, [&] {
    made = true;
    return reflections::integrated_brdf(options, control);
  });
  if (!made && control.progress) control.progress(1.0);
  return table;
}

std::shared_ptr<const BrdfTable> brdf_table(const BrdfTableOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  bool made = false;
  return reflections::shared_brdf(options, control, made);
}

}  // namespace welkin
