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

std::uint64_t squared(int edge) { return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge); }

void check(const BakeOptions& options) {
  image::require_range("background_size", options.background_size, 0, image::kLargestFace);
  image::require_range("irradiance_size", options.irradiance_size, 0, kLargestIrradiance);
  image::require_range("bands", options.bands, 0, kMaximumBands);
  image::require_range("projected_bands", options.projected_bands, 0, kMaximumBands);
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
  projecting.bands = options.bands > 0 ? std::max(options.bands, options.projected_bands) : 1;
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

std::uint64_t chain_texels(int size, int levels) noexcept {
  std::uint64_t texels = 0;
  for (int level = 0; level < levels; ++level) texels += 6 * squared(std::max(1, size >> level));
  return texels;
}

BakePlan plan_bake(const SourceShape& source, const BakeOptions& options, const StoredKinds& stored,
                   const CostModel& costs) {
  check(options);
  BakePlan plan;
  plan.projecting = projection_of(options);
  sh::check_options(plan.projecting);
  plan.background_size = background_size_of(source, options);
  if (plan.background_size > 0) {
    plan.background_levels = options.background_mips ? full_chain_levels(plan.background_size) : 1;
  }
  if (options.specular && stored.specular_mips > 0) {
    plan.stored_specular = true;
    plan.specular_size = stored.specular_size;
    plan.specular_mips = stored.specular_mips;
  } else if (options.specular) {
    const specular::PrefilterPlan prefiltering = specular::plan_prefilter(*options.specular);
    plan.specular_size = prefiltering.mips.front().size;
    plan.specular_mips = static_cast<int>(prefiltering.mips.size());
    plan.same_level = prefiltering.mips.front().copy && plan.background_size == plan.specular_size;
  }
  plan.stored_harmonics = options.bands > 0 && options.bands <= stored.harmonics_bands;
  plan.stored_background = source.cubemap && plan.background_levels > 1 && plan.background_size == source.columns &&
                           stored.background_levels >= plan.background_levels;
  plan.steps = steps_of(source, options, plan);
  predict(source, options, costs, plan);
  return plan;
}

void require_memory(std::uint64_t result_bytes, std::uint64_t working_bytes, const BakeOptions& options) {
  const std::uint64_t needed = result_bytes + working_bytes;
  if (needed <= options.memory_limit_bytes) return;
  throw Error(ErrorCode::limit_exceeded, "the bake may need " + std::to_string(needed) + " bytes (results " +
                                             std::to_string(result_bytes) + ", working memory " +
                                             std::to_string(working_bytes) + ") and the limit is " +
                                             std::to_string(options.memory_limit_bytes) +
                                             "; pass smaller sizes, leave results out, or raise memory_limit_bytes");
}

}  // namespace welkin::baking
