// Which passes a bake has: run, reused or left out, why, and what waits for what.
#include "bake/bake_plan.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "image/pixels.h"
#include "projection/sanitizer.h"
#include "reflections/brdf_table.h"
#include "reflections/prefilter_plan.h"
#include "welkin/core.h"
#include "welkin/irradiance.h"
#include "welkin/plan.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

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

}  // namespace welkin

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
  if (options.brdf) reflections::check_brdf(*options.brdf);
}

ProjectionOptions projection_of(const BakeOptions& options) {
  ProjectionOptions projecting;
  projecting.bands = options.bands > 0 ? std::max(options.bands, options.projected_bands) : 1;
  projecting.pixels = options.pixels;
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
  projection::check_options(plan.projecting);
  plan.background_size = background_size_of(source, options);
  if (plan.background_size > 0) {
    plan.background_levels = options.background_mips ? full_chain_levels(plan.background_size) : 1;
  }
  if (options.specular && stored.specular_mips > 0) {
    plan.stored_specular = true;
    plan.specular_size = stored.specular_size;
    plan.specular_mips = stored.specular_mips;
  } else if (options.specular) {
    const reflections::PrefilterPlan prefiltering = reflections::plan_prefilter(*options.specular);
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

namespace {

constexpr const char* kNotAskedFor = "not asked for";

std::string edge(int size) { return std::to_string(size) + " x " + std::to_string(size); }

BakeStep step(BakePass pass, PassAction action, std::string reason, std::vector<BakePass> after = {}) {
  return {pass, {name(pass), action, std::move(reason), 0.0, 0}, std::move(after)};
}

BakeStep skipped(BakePass pass, std::string reason = kNotAskedFor) {
  return step(pass, PassAction::skip, std::move(reason));
}

BakeStep sanitize_step(const SourceShape& source, const BakeOptions& options, const BakePlan& plan) {
  const bool direct = options.irradiance_size > 0 && options.irradiance_method == IrradianceMethod::direct;
  const bool specular = options.specular && !plan.stored_specular;
  const bool background = plan.background_size > 0;
  if (!specular && !background && !direct)
    return skipped(BakePass::sanitize, "no pass wants pixels but the projection, which cleans on the fly");
  if (source.format == PixelFormat::rgb32f && !options.pixels.clamp && !options.pixels.gamma)
    return step(BakePass::sanitize, PassAction::reuse, "RGB floats are looked through, and copied only if not clean");
  return step(BakePass::sanitize, PassAction::run, "a copy as RGB floats, clamped and replaced as asked for");
}

BakeStep specular_step(const BakeOptions& options, const BakePlan& plan) {
  if (!options.specular) return skipped(BakePass::specular);
  if (plan.stored_specular) {
    return step(
        BakePass::specular, PassAction::reuse,
        std::to_string(plan.specular_mips) + " mips from " + edge(plan.specular_size) + " came with the pixels");
  }
  std::string what = std::to_string(plan.specular_mips) + " mips from " + edge(plan.specular_size);
  const int left_out = options.specular->leave_out_sharp + options.specular->leave_out_rough;
  if (left_out > 0) {
    what += "; left out: " + std::to_string(options.specular->leave_out_sharp) + " sharper, " +
            std::to_string(options.specular->leave_out_rough) + " rougher";
  }
  return step(BakePass::specular, PassAction::run, what, {BakePass::sanitize});
}

BakeStep background_step(const SourceShape& source, const BakePlan& plan) {
  if (plan.background_size == 0) return skipped(BakePass::background);
  if (plan.same_level) {
    return step(BakePass::background, PassAction::reuse, "mip 0 of the specular cubemap is the same",
                {BakePass::specular});
  }
  return step(BakePass::background, PassAction::run,
              source.words() + " to faces of " + edge(plan.background_size) + ", by area", {BakePass::sanitize});
}

BakeStep background_mips_step(const BakeOptions& options, const BakePlan& plan) {
  if (plan.background_size == 0) return skipped(BakePass::background_mips, "there is no background");
  if (plan.background_levels == 1)
    return skipped(BakePass::background_mips, options.background_mips ? "level 0 is 1 texel" : kNotAskedFor);
  const std::string levels = std::to_string(plan.background_levels) + " levels";
  if (plan.stored_background)
    return step(BakePass::background_mips, PassAction::reuse, levels + " came with the pixels", {BakePass::background});
  return step(
      BakePass::background_mips, PassAction::run,
      levels + ", each from the one above, by " + (options.mip_filter == MipFilter::box ? "plain mean" : "solid angle"),
      {BakePass::background});
}

BakeStep project_step(const BakeOptions& options, const BakePlan& plan) {
  if (plan.stored_harmonics)
    return step(BakePass::project, PassAction::reuse, "the harmonics that came with the pixels");
  if (options.bands > 0) {
    std::string bands = std::to_string(options.bands) + (options.bands > 1 ? " bands" : " band");
    if (plan.projecting.bands > options.bands) bands += " of " + std::to_string(plan.projecting.bands);
    return step(BakePass::project, PassAction::run, bands + " from the source's own texels");
  }
  if (!options.total_radiance) return skipped(BakePass::project);
  return step(BakePass::project, PassAction::run, "1 band, for the total radiance: no coefficients were asked for");
}

BakeStep irradiance_step(const BakeOptions& options) {
  if (options.irradiance_size == 0) return skipped(BakePass::irradiance);
  const std::string size = edge(options.irradiance_size);
  if (options.irradiance_method == IrradianceMethod::direct)
    return step(BakePass::irradiance, PassAction::run, size + " by direct convolution in double", {BakePass::sanitize});
  return step(BakePass::irradiance, PassAction::run, size + " from " + std::to_string(options.bands) + " bands",
              {BakePass::project});
}

BakeStep brdf_step(const BakeOptions& options) {
  if (!options.brdf) return skipped(BakePass::brdf);
  return step(BakePass::brdf, PassAction::run,
              std::to_string(options.brdf->width) + " x " + std::to_string(options.brdf->height) + " by quadrature");
}

}  // namespace

const char* name(BakePass pass) noexcept {
  switch (pass) {
    case BakePass::sanitize: return "clean";
    case BakePass::specular: return "specular";
    case BakePass::background: return "background";
    case BakePass::background_mips: return "background mips";
    case BakePass::project: return "project";
    case BakePass::irradiance: return "irradiance";
    case BakePass::brdf: break;
  }
  return "brdf";
}

std::vector<BakeStep> steps_of(const SourceShape& source, const BakeOptions& options, const BakePlan& plan) {
  return {sanitize_step(source, options, plan),
          specular_step(options, plan),
          background_step(source, plan),
          background_mips_step(options, plan),
          project_step(options, plan),
          irradiance_step(options),
          brdf_step(options)};
}

}  // namespace welkin::baking
