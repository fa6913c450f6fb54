#include <algorithm>
#include <array>
#include <bit>

#include "bake/bake_plan.h"
#include "image/sphere_grid.h"
#include "reflections/brdf_table.h"
#include "reflections/prefilter_plan.h"
#include "transform/spectrum.h"
#include "transform/transform_kernels.h"
#include "welkin/plan.h"

namespace welkin::baking {
namespace {

constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);
constexpr std::uint64_t kSmallChange = std::uint64_t{2} << 20U;  ///< scratch space of tiles, lists of rows

std::uint64_t squared(int edge) { return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge); }

/// Of the transform: orders times rings, in groups of lanes.
std::uint64_t columns_bytes(int bands, int rings) {
  const auto groups = static_cast<std::uint64_t>((rings + 1) / 2 + transforms::kRingLanes) / transforms::kRingLanes;
  return static_cast<std::uint64_t>(bands) * groups * transforms::kColumnFloats * sizeof(float);
}

/// What the prefilter holds when all of its mips are being made.
std::uint64_t prefilter_bytes(const SourceShape& source, const reflections::PrefilterPlan& plan) {
  std::uint64_t bytes = 0;
  const int rings = source.cubemap ? plan.rows_for_cubemap(source.columns) : source.rows;
  const std::uint64_t ring_texels = source.cubemap ? 2 * squared(rings) : source.texels();
  if (plan.bands > 0) {
    if (source.cubemap) bytes += (24 + 9) * ring_texels;  // of `rings_of_cubemap`
    bytes += kTexelBytes * ring_texels + columns_bytes(plan.bands, rings);
    bytes += squared(plan.bands) * transforms::kHarmonicFloats * sizeof(float);
  }
  for (const reflections::MipPlan& mip : plan.mips) {
    if (mip.copy || plan.sampled) bytes += kTexelBytes * 6 * squared(mip.size);
    if (mip.bands.bands() == 0) continue;
    const transforms::GridSize grid = transforms::grid_for_bands(mip.bands.bands());
    constexpr int border = 2 * image::SphereGrid::kBorder;
    bytes += columns_bytes(mip.bands.bands(), grid.rings) + sizeof(float) * 4 *
                                                                static_cast<std::uint64_t>(grid.rings + border) *
                                                                static_cast<std::uint64_t>(grid.columns + border);
  }
  // The chain that is sampled, with a border, from level 0 down.
  if (plan.sampled) bytes += 4 * sizeof(float) * 12 * squared(plan.size + 4);
  return bytes;
}

double cube_texels(int edge) { return 6.0 * edge * edge; }

double texels_of_chain(int size, int levels) { return static_cast<double>(chain_texels(size, levels)); }

/// How a cubemap is reduced by a power of two: as its mips are.
bool halves(int source_size, int size) {
  return source_size % size == 0 && std::has_single_bit(static_cast<unsigned>(source_size / size));
}

/// A texel of the result takes a look; where it is coarser than the source, all of what it covers.
double resampling(const SourceShape& source, int size, const CostModel& costs) {
  if (source.cubemap && source.columns == size) return costs.copy_texel * cube_texels(size);
  if (source.cubemap && halves(source.columns, size)) return costs.mip_texel * static_cast<double>(source.texels());
  if (source.cubemap) {
    return costs.resample_cube_texel * cube_texels(size) +
           costs.resample_cube_source * static_cast<double>(source.texels());
  }
  return costs.resample_texel * cube_texels(size) + costs.resample_source * static_cast<double>(source.texels());
}

double projecting(double texels, int bands, const CostModel& costs) {
  return texels * (costs.project_texel + 0.5 * costs.project_sum * bands * (bands + 1));
}

/// Both halves of a transform: rings by Fourier, orders by Legendre. Functions vanish near the poles: half of them
/// count.
double transforming(double rings, double columns, int bands, const CostModel& costs) {
  return costs.fourier_texel * rings * columns + costs.legendre_term * 0.25 * bands * bands * rings;
}

double prefiltering(const SourceShape& source, const reflections::PrefilterPlan& plan, int samples,
                    const CostModel& costs) {
  const double rings = source.cubemap ? plan.rows_for_cubemap(source.columns) : source.rows;
  const double columns = source.cubemap ? 2.0 * rings : source.columns;
  double cost = 0.0;
  if (plan.bands > 0) {
    if (source.cubemap) cost += costs.ring_texel * rings * columns;
    cost += costs.bright_texel * rings * columns + transforming(rings, columns, plan.bands, costs);
  }
  if (plan.sampled) {
    cost += resampling(source, plan.size, costs) + (costs.mip_texel + costs.copy_texel) * cube_texels(plan.size);
  }
  for (const reflections::MipPlan& mip : plan.mips) {
    const double texels = cube_texels(mip.size);
    cost += projecting(texels, 1, costs);  // its mean
    if (mip.copy) {
      cost += resampling(source, mip.size, costs);
    } else if (mip.method == PrefilterMethod::sampled) {
      cost += costs.tap * texels * samples;
    } else if (mip.method == PrefilterMethod::reference) {
      cost += texels * (costs.reference_pair * static_cast<double>(source.texels()) + costs.reference_direction);
    } else {
      const transforms::GridSize grid = transforms::grid_for_bands(mip.bands.bands());
      cost += transforming(grid.rings, grid.columns, mip.bands.bands(), costs) + costs.face_texel * texels;
    }
  }
  return cost;
}

double irradiating(const SourceShape& source, const BakeOptions& options, const CostModel& costs) {
  const double texels = cube_texels(options.irradiance_size);
  if (options.irradiance_method == IrradianceMethod::direct)
    return texels * (costs.irradiance_pair * static_cast<double>(source.texels()) + costs.irradiance_direction);
  return costs.irradiance_term * texels * options.bands * options.bands;
}

double tabulating(const BrdfTableOptions& options, const CostModel& costs) {
  return (options.sheen ? costs.sheen_texel : costs.brdf_texel) * options.width * options.height;
}

/// Nanoseconds of one thread.
double cost_of(BakePass pass, const SourceShape& source, const BakeOptions& options, const CostModel& costs,
               const BakePlan& plan) {
  const bool reuse = plan.step(pass).planned.action == PassAction::reuse;
  switch (pass) {
    case BakePass::sanitize: return costs.clean_texel * static_cast<double>(source.texels());
    case BakePass::specular:
      if (reuse) return costs.copy_texel * texels_of_chain(plan.specular_size, plan.specular_mips);
      return prefiltering(source, reflections::plan_prefilter(*options.specular), options.specular->samples, costs);
    case BakePass::background:
      if (reuse) return costs.copy_texel * cube_texels(plan.background_size);
      return resampling(source, plan.background_size, costs);
    case BakePass::background_mips:
      if (reuse) return costs.copy_texel / 3.0 * cube_texels(plan.background_size);
      return costs.mip_texel * cube_texels(plan.background_size);
    case BakePass::project:
      if (reuse) return 0.0;
      return projecting(static_cast<double>(source.texels()), plan.projecting.bands, costs);
    case BakePass::irradiance: return irradiating(source, options, costs);
    case BakePass::brdf: break;
  }
  return tabulating(*options.brdf, costs);
}

/// Result and working memory; `BakePlan` adds them up.
struct Bytes {
  std::uint64_t result = 0;
  std::uint64_t working = 0;
};

Bytes bytes_of(BakePass pass, const SourceShape& source, const BakeOptions& options, const BakePlan& plan) {
  const bool reuse = plan.step(pass).planned.action == PassAction::reuse;
  const std::uint64_t level = kTexelBytes * chain_texels(plan.background_size, 1);
  switch (pass) {
    case BakePass::sanitize: return {0, kTexelBytes * source.texels()};  // reuse is a hope: the pixels may need a copy
    case BakePass::specular: {
      const std::uint64_t chain = kTexelBytes * chain_texels(plan.specular_size, plan.specular_mips);
      return {chain, reuse ? 0 : prefilter_bytes(source, reflections::plan_prefilter(*options.specular))};
    }
    case BakePass::background: return {level, source.cubemap && !reuse ? level : 0};
    case BakePass::background_mips:
      return {kTexelBytes * chain_texels(plan.background_size, plan.background_levels) - level, 0};
    case BakePass::project: return {};
    case BakePass::irradiance: return {kTexelBytes * 6 * squared(options.irradiance_size), 0};
    case BakePass::brdf: break;
  }
  return {sizeof(float) * reflections::brdf_values(*options.brdf), 0};
}

}  // namespace

void predict(const SourceShape& source, const BakeOptions& options, const CostModel& costs, BakePlan& plan) {
  constexpr double kNanoseconds = 1e6;  ///< in a millisecond
  plan.result_bytes = 0;
  plan.working_bytes = kSmallChange;
  for (BakeStep& step : plan.steps) {
    if (step.planned.action == PassAction::skip) continue;
    const Bytes bytes = bytes_of(step.pass, source, options, plan);
    step.planned.bytes = bytes.result + bytes.working;
    step.planned.predicted_milliseconds = cost_of(step.pass, source, options, costs, plan) / kNanoseconds;
    plan.result_bytes += bytes.result;
    plan.working_bytes += bytes.working;
  }
}

}  // namespace welkin::baking

namespace welkin {

std::span<const CostUnit> cost_units() noexcept {
  static constexpr std::array kUnits = {CostUnit{"clean_texel", &CostModel::clean_texel},
                                        CostUnit{"project_texel", &CostModel::project_texel},
                                        CostUnit{"project_sum", &CostModel::project_sum},
                                        CostUnit{"resample_texel", &CostModel::resample_texel},
                                        CostUnit{"resample_source", &CostModel::resample_source},
                                        CostUnit{"resample_cube_texel", &CostModel::resample_cube_texel},
                                        CostUnit{"resample_cube_source", &CostModel::resample_cube_source},
                                        CostUnit{"mip_texel", &CostModel::mip_texel},
                                        CostUnit{"copy_texel", &CostModel::copy_texel},
                                        CostUnit{"read_texel", &CostModel::read_texel},
                                        CostUnit{"read_plain_texel", &CostModel::read_plain_texel},
                                        CostUnit{"ring_texel", &CostModel::ring_texel},
                                        CostUnit{"bright_texel", &CostModel::bright_texel},
                                        CostUnit{"fourier_texel", &CostModel::fourier_texel},
                                        CostUnit{"legendre_term", &CostModel::legendre_term},
                                        CostUnit{"face_texel", &CostModel::face_texel},
                                        CostUnit{"tap", &CostModel::tap},
                                        CostUnit{"reference_pair", &CostModel::reference_pair},
                                        CostUnit{"reference_direction", &CostModel::reference_direction},
                                        CostUnit{"irradiance_term", &CostModel::irradiance_term},
                                        CostUnit{"irradiance_pair", &CostModel::irradiance_pair},
                                        CostUnit{"irradiance_direction", &CostModel::irradiance_direction},
                                        CostUnit{"brdf_texel", &CostModel::brdf_texel},
                                        CostUnit{"sheen_texel", &CostModel::sheen_texel},
                                        CostUnit{"transmittance_texel", &CostModel::transmittance_texel},
                                        CostUnit{"sun_path_node", &CostModel::sun_path_node},
                                        CostUnit{"first_order_node", &CostModel::first_order_node},
                                        CostUnit{"order_node", &CostModel::order_node},
                                        CostUnit{"scattered_once", &CostModel::scattered_once},
                                        CostUnit{"scattered_often", &CostModel::scattered_often},
                                        CostUnit{"slice_texel", &CostModel::slice_texel},
                                        CostUnit{"sky_direction", &CostModel::sky_direction},
                                        CostUnit{"projected_direction", &CostModel::projected_direction}};
  return kUnits;
}

}  // namespace welkin
