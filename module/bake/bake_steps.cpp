// Which passes a bake has: run, reused or left out, why, and what waits for what.
#include <string>

#include "bake/bake_plan.h"
#include "welkin/irradiance_cubemap.h"

namespace welkin {

const char* name(PassAction action) noexcept {
  switch (action) {
    case PassAction::run: return "run";
    case PassAction::reuse: return "reuse";
    case PassAction::skip: break;
  }
  return "skip";
}

}  // namespace welkin

namespace welkin::baking {
namespace {

constexpr const char* kNotAskedFor = "not asked for";

std::string edge(int size) { return std::to_string(size) + " x " + std::to_string(size); }

BakeStep step(BakePass pass, PassAction action, std::string reason, std::vector<BakePass> after = {}) {
  return {pass, {name(pass), action, std::move(reason), 0.0, 0}, std::move(after)};
}

BakeStep skipped(BakePass pass, std::string reason = kNotAskedFor) {
  return step(pass, PassAction::skip, std::move(reason));
}

BakeStep clean_step(const SourceShape& source, const BakeOptions& options, const BakePlan& plan) {
  const bool direct = options.irradiance_size > 0 && options.irradiance_method == IrradianceMethod::direct;
  const bool specular = options.specular && !plan.stored_specular;
  const bool background = plan.background_size > 0;
  if (!specular && !background && !direct)
    return skipped(BakePass::clean, "no pass wants pixels but the projection, which cleans on the fly");
  if (source.format == PixelFormat::rgb_f32 && !options.pixels.clamp && !options.pixels.gamma)
    return step(BakePass::clean, PassAction::reuse, "RGB floats are looked through, and copied only if not clean");
  return step(BakePass::clean, PassAction::run, "a copy as RGB floats, clamped and replaced as asked for");
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
  return step(BakePass::specular, PassAction::run, what, {BakePass::clean});
}

BakeStep background_step(const SourceShape& source, const BakePlan& plan) {
  if (plan.background_size == 0) return skipped(BakePass::background);
  if (plan.same_level) {
    return step(BakePass::background, PassAction::reuse, "mip 0 of the specular cubemap is the same",
                {BakePass::specular});
  }
  return step(BakePass::background, PassAction::run,
              source.words() + " to faces of " + edge(plan.background_size) + ", by area", {BakePass::clean});
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
  if (!options.flux) return skipped(BakePass::project);
  return step(BakePass::project, PassAction::run, "1 band, for the flux: no coefficients were asked for");
}

BakeStep irradiance_step(const BakeOptions& options) {
  if (options.irradiance_size == 0) return skipped(BakePass::irradiance);
  const std::string size = edge(options.irradiance_size);
  if (options.irradiance_method == IrradianceMethod::direct)
    return step(BakePass::irradiance, PassAction::run, size + " by direct convolution in double", {BakePass::clean});
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
    case BakePass::clean: return "clean";
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
  return {clean_step(source, options, plan),
          specular_step(options, plan),
          background_step(source, plan),
          background_mips_step(options, plan),
          project_step(options, plan),
          irradiance_step(options),
          brdf_step(options)};
}

}  // namespace welkin::baking
