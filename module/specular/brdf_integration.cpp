#include "specular/brdf_integration.h"

#include <algorithm>
#include <array>

#include "jobs/tiles.h"
#include "simd/kernels.h"
#include "specular/brdf_quadrature.h"

namespace welkin::specular {
namespace {

/// 64 texels of a row: some 0.1 ms with AVX-512, 0.4 with SSE2.
constexpr int kTileColumns = 4 * simd::kLanes;

/// Fills texels [first, first + count) of a row, count <= 16. What lies beyond the row is computed and dropped.
void fill_group(const simd::Kernels& kernels, const AlbedoRules& rules, int row, int first, int count,
                BrdfTable& table) {
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
  const simd::Kernels& kernels = simd::active_kernels();
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

}  // namespace welkin::specular
