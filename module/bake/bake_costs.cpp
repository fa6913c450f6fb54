#include <algorithm>

#include "bake/bake_plan.h"
#include "image/sphere_grid.h"
#include "simd/transform_kernels.h"
#include "specular/brdf_integration.h"
#include "specular/prefilter_plan.h"
#include "specular/spectrum.h"

namespace welkin::baking {
namespace {

constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);
constexpr std::uint64_t kSmallChange = std::uint64_t{2} << 20U;  ///< scratch space of tiles, lists of rows

std::uint64_t squared(int edge) { return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge); }

/// Of the transform: orders times rings, in groups of lanes.
std::uint64_t columns_bytes(int bands, int rings) {
  const auto groups = static_cast<std::uint64_t>((rings + 1) / 2 + simd::kRingLanes) / simd::kRingLanes;
  return static_cast<std::uint64_t>(bands) * groups * simd::kColumnFloats * sizeof(float);
}

/// What the prefilter holds when all of its mips are being made.
std::uint64_t prefilter_bytes(const SourceShape& source, const specular::PrefilterPlan& plan) {
  std::uint64_t bytes = 0;
  const int rings = source.cubemap ? plan.rows_for_cubemap(source.columns) : source.rows;
  const std::uint64_t ring_texels = source.cubemap ? 2 * squared(rings) : source.texels();
  if (plan.bands > 0) {
    if (source.cubemap) bytes += (24 + 9) * ring_texels;  // of `rings_of_cubemap`
    bytes += kTexelBytes * ring_texels + columns_bytes(plan.bands, rings);
    bytes += squared(plan.bands) * simd::kHarmonicFloats * sizeof(float);
  }
  for (const specular::MipPlan& mip : plan.mips) {
    if (mip.copy || plan.sampled) bytes += kTexelBytes * 6 * squared(mip.size);
    if (mip.bands.bands() == 0) continue;
    const specular::GridSize grid = specular::grid_for_bands(mip.bands.bands());
    constexpr int border = 2 * image::SphereGrid::kBorder;
    bytes += columns_bytes(mip.bands.bands(), grid.rings) + sizeof(float) * 4 *
                                                                static_cast<std::uint64_t>(grid.rings + border) *
                                                                static_cast<std::uint64_t>(grid.columns + border);
  }
  // The chain that is sampled, with a border, from level 0 down.
  if (plan.sampled) bytes += 4 * sizeof(float) * 12 * squared(plan.mips.front().size + 4);
  return bytes;
}

double cube_texels(int edge) { return 6.0 * edge * edge; }

}  // namespace

std::uint64_t working_bytes(const SourceShape& source, const BakeOptions& options, const BakePlan& plan) {
  std::uint64_t bytes = 0;
  if (plan.cleans) bytes += kTexelBytes * source.texels();
  if (source.cubemap && plan.background_size > 0 && !plan.same_level)
    bytes += kTexelBytes * 6 * squared(plan.background_size);
  if (options.specular) bytes += prefilter_bytes(source, specular::plan_prefilter(*options.specular));
  return bytes + kSmallChange;
}

PassCosts expected_costs(const SourceShape& source, const BakeOptions& options, const BakePlan& plan) {
  const auto source_texels = static_cast<double>(source.texels());
  // A texel of the result takes at least a look; where it is coarser than the source, all of what it covers.
  const auto resampling = [&](int size) { return 6.0 * cube_texels(size) + 1.5 * source_texels; };
  PassCosts costs;
  costs.clean = 0.5 * source_texels;
  costs.background = resampling(plan.background_size);
  costs.background_mips = 1.5 * cube_texels(plan.background_size);
  costs.specular = 20.0 * source_texels + 6.0 * cube_texels(plan.specular_size);
  costs.project = 0.5 * source_texels * std::max(1.0, plan.projecting.bands / 3.0);
  const double irradiance_texels = cube_texels(options.irradiance_size);
  costs.irradiance = options.irradiance_method == IrradianceMethod::direct
                         ? 5.0 * source_texels * irradiance_texels
                         : 2.0 * irradiance_texels * plan.projecting.bands * plan.projecting.bands;
  if (options.brdf) costs.brdf = 500.0 * static_cast<double>(specular::brdf_values(*options.brdf));
  // A cost of nothing would be no weight: at least what a pass takes to begin.
  for (double* cost : {&costs.clean, &costs.background, &costs.background_mips, &costs.specular, &costs.project,
                       &costs.irradiance, &costs.brdf}) {
    *cost = std::max(*cost, 10'000.0);
  }
  return costs;
}

}  // namespace welkin::baking
