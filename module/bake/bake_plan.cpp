#include "bake/bake_plan.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "image/check_views.h"
#include "sh/check_arguments.h"
#include "specular/brdf_integration.h"
#include "specular/prefilter_plan.h"
#include "welkin/error.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::baking {
namespace {

constexpr int kLargestIrradiance = 4096;
constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);

std::uint64_t squared(int edge) { return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge); }

/// Texels of a chain.
std::uint64_t chain_texels(int size, int levels) {
  std::uint64_t texels = 0;
  for (int level = 0; level < levels; ++level) texels += 6 * squared(std::max(1, size >> level));
  return texels;
}

void check(const BakeOptions& options) {
  image::require_range("background_size", options.background_size, 0, image::kLargestFace);
  image::require_range("irradiance_size", options.irradiance_size, 0, kLargestIrradiance);
  image::require_range("bands", options.bands, 0, kMaximumBands);
  if (options.irradiance_size > 0 && options.bands == 0 && options.irradiance_method == IrradianceMethod::harmonics) {
    throw Error(ErrorCode::invalid_argument,
                "an irradiance cubemap from harmonics needs some, and bands is 0; pass 3, irradiance_size = 0 or "
                "irradiance_method = direct");
  }
  if (options.brdf) specular::check_brdf(*options.brdf);
}

/// Of the options for pixels those that act on them; the others belong to a plain projection.
ProjectionOptions projection_of(const BakeOptions& options) {
  ProjectionOptions projecting;
  projecting.bands = std::max(1, options.bands);
  projecting.clamp = options.pixels.clamp;
  projecting.gamma = options.pixels.gamma;
  projecting.nan = options.pixels.nan;
  projecting.infinity = options.pixels.infinity;
  projecting.negative = options.pixels.negative;
  return projecting;
}

int background_size_of(const SourceShape& source, const BakeOptions& options) {
  if (!options.background) return 0;
  if (options.background_size > 0) return options.background_size;
  if (options.specular) return options.specular->size;
  return source.cubemap ? source.columns : std::max(1, source.columns / 4);
}

}  // namespace

std::string SourceShape::words() const {
  return cubemap ? "cubemap of " + std::to_string(columns)
                 : "lat-long " + std::to_string(columns) + " x " + std::to_string(rows);
}

SourceShape shape_of(const LatLongView& view) {
  image::check_view(view);
  return {false, view.width, view.height, view.format};
}

SourceShape shape_of(const CubemapView& view) {
  image::check_view(view);
  return {true, view.size, 6 * view.size, view.format};
}

BakePlan plan_bake(const SourceShape& source, const BakeOptions& options) {
  check(options);
  BakePlan plan;
  plan.projecting = projection_of(options);
  sh::check_options(plan.projecting);
  plan.background_size = background_size_of(source, options);
  if (plan.background_size > 0) {
    plan.background_levels = options.background_mips ? full_chain_levels(plan.background_size) : 1;
  }
  if (options.specular) {
    const specular::PrefilterPlan prefiltering = specular::plan_prefilter(*options.specular);
    plan.specular_size = options.specular->size;
    plan.specular_mips = static_cast<int>(prefiltering.mips.size());
    plan.same_level = prefiltering.mips.front().copy && plan.background_size == plan.specular_size;
  }
  const bool direct = options.irradiance_size > 0 && options.irradiance_method == IrradianceMethod::direct;
  plan.cleans = plan.background_size > 0 || plan.specular_size > 0 || direct;

  const std::uint64_t background_texels = chain_texels(plan.background_size, plan.background_levels);
  const std::uint64_t specular_texels = chain_texels(plan.specular_size, plan.specular_mips);
  const std::uint64_t irradiance_texels = 6 * squared(options.irradiance_size);
  plan.result_bytes = kTexelBytes * (background_texels + specular_texels + irradiance_texels);
  if (options.brdf) plan.result_bytes += sizeof(float) * specular::brdf_values(*options.brdf);
  plan.working_bytes = working_bytes(source, options, plan);
  plan.costs = expected_costs(source, options, plan);
  return plan;
}

void require_memory(const BakePlan& plan, const BakeOptions& options) {
  const std::uint64_t needed = plan.result_bytes + plan.working_bytes;
  if (needed <= options.memory_limit_bytes) return;
  throw Error(ErrorCode::limit_exceeded, "the bake may need " + std::to_string(needed) + " bytes (results " +
                                             std::to_string(plan.result_bytes) + ", working memory " +
                                             std::to_string(plan.working_bytes) + ") and the limit is " +
                                             std::to_string(options.memory_limit_bytes) +
                                             "; pass smaller sizes, leave results out, or raise memory_limit_bytes");
}

}  // namespace welkin::baking
