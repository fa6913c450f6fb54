#include "reflections/brdf_table.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <string>

#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "reflections/brdf_kernels.h"
#include "simd/dispatch.h"
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

math::TableCache<BrdfTableOptions, BrdfTable>& cache() {
  static auto& tables = *new math::TableCache<BrdfTableOptions, BrdfTable>(kCacheBytes);  // never destroyed
  return tables;
}

}  // namespace

std::vector<std::uint16_t> BrdfTable::half_values() const {
  const platform::FloatingPointScope floating_point;
  std::vector<std::uint16_t> halves(values.size());
  std::transform(values.begin(), values.end(), halves.begin(), image::half_from_float);
  return halves;
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
  made = false;
  std::shared_ptr<const BrdfTable> table = cache().get(options, [&] {
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

namespace welkin::reflections {
namespace {

/// 64 texels of a row: some 0.1 ms with AVX-512, 0.4 with SSE2.
constexpr int kTileColumns = 4 * simd::kLanes;

/// Fills texels [first, first + count) of a row, count <= 16. What lies beyond the row is computed and dropped.
void fill_group(const BrdfKernels& kernels, const AlbedoRules& rules, int row, int first, int count, BrdfTable& table) {
  const BrdfTableOptions& options = table.options;
  const double roughness = (row + 0.5) / options.height;
  const double first_cosine = (first + 0.5) / options.width;
  std::array<float, simd::kLanes> normal_view{};
  std::array<float, simd::kLanes> whole{};
  std::array<float, simd::kLanes> fresnel{};
  std::array<float, simd::kLanes> sheen{};
  for (int lane = 0; lane < simd::kLanes; ++lane) {
    const double cosine = (first + std::min(lane, count - 1) + 0.5) / options.width;
    normal_view[static_cast<std::size_t>(lane)] = static_cast<float>(cosine);
  }
  const auto alpha = static_cast<float>(roughness * roughness);
  kernels.directional_albedo(rules.ggx(roughness, first_cosine), alpha, normal_view.data(), whole.data(),
                             fresnel.data());
  if (options.sheen) kernels.sheen_albedo(rules.sheen(roughness), alpha, normal_view.data(), sheen.data());
  const auto channels = static_cast<std::size_t>(table.channels);
  const std::size_t texel =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(first);
  float* out = table.values.data() + texel * channels;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k, out += channels) {
    const bool split = options.model == BrdfModel::split_sum;
    out[0] = split ? whole[k] - fresnel[k] : fresnel[k];
    out[1] = split ? fresnel[k] : whole[k];
    if (options.sheen) out[2] = sheen[k];
  }
}

}  // namespace

std::size_t brdf_values(const BrdfTableOptions& options) noexcept {
  return static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height) *
         static_cast<std::size_t>(options.sheen ? 3 : 2);
}

std::shared_ptr<const BrdfTable> integrated_brdf(const BrdfTableOptions& options, const Control& control) {
  auto table = std::make_shared<BrdfTable>();
  table->options = options;
  table->channels = options.sheen ? 3 : 2;
  table->values.resize(brdf_values(options));
  const AlbedoRules rules;
  const BrdfKernels& kernels = brdf_kernels();
  const int tiles_a_row = (options.width + kTileColumns - 1) / kTileColumns;
  const std::size_t tiles = static_cast<std::size_t>(tiles_a_row) * static_cast<std::size_t>(options.height);
  const auto placement =
      brdf_values(options) <= 3 * kTileColumns ? jobs::Placement::calling_thread : jobs::Placement::arena;
  jobs::run_tiles(tiles, placement, jobs::worker_count(placement), control, [&](std::size_t tile, std::size_t) {
    const int row = static_cast<int>(tile / static_cast<std::size_t>(tiles_a_row));
    const int begin = static_cast<int>(tile % static_cast<std::size_t>(tiles_a_row)) * kTileColumns;
    const int end = std::min(begin + kTileColumns, options.width);
    for (int column = begin; column < end; column += simd::kLanes) {
      fill_group(kernels, rules, row, column, std::min(simd::kLanes, end - column), *table);
    }
  });
  return table;
}

}  // namespace welkin::reflections
