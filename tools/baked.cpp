#include "tools/baked.h"

#include "tools/bake_memory.h"
#include "tools/bake_source.h"
#include "tools/progress_bar.h"
#include "welkin/cubemap_chain.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"

namespace welkin::tool {
namespace {

// Shares of the progress.
constexpr double kRead = 0.15;
constexpr double kBaked = 0.75;

/// What the .env needs: Babylon.js computes the mip from the roughness by a formula of its own, down to one texel.
PrefilterOptions env_options(const PrefilterOptions& specular) {
  PrefilterOptions env = specular;
  env.size = env_size(specular.size);
  env.mips = full_chain_levels(env.size);
  env.roughness = roughness_of_mips(RoughnessSchedule::babylon, env.mips, env.size);
  return env;
}

/// Replaces what came from the pixels of an .env, which end at 255, as `bake_file` does: up to three bands, and the
/// irradiance cubemap unless it was to be integrated directly.
void use_stored_light(Baked& baked, const Control& control) {
  const int bands = baked.options.bands;
  if (!baked.stored_light || bands == 0 || bands > baked.stored_light->radiance.bands()) return;
  BakeResult& light = baked.light;
  light.radiance = with_bands(baked.stored_light->radiance, bands);
  const ProjectionDiagnostics& stored = baked.stored_light->diagnostics;
  light.diagnostics.flux = stored.flux;
  light.diagnostics.flux_before_clamp = stored.flux_before_clamp;
  light.diagnostics.error_estimate = stored.error_estimate;
  if (baked.options.irradiance_size == 0 || baked.options.irradiance_method != IrradianceMethod::harmonics) return;
  light.irradiance =
      irradiance_cubemap(irradiance_from_radiance(*light.radiance), baked.options.irradiance_size, {control.stop, {}});
}

}  // namespace

Baked bake_source(const BakeCommandOptions& options, const Control& control) {
  Baked baked;
  baked.options = library_options(options);
  BakeSource source =
      timed(baked.passes, "read", "the input", [&] { return BakeSource(options, part_of(control, 0.0, kRead)); });
  baked.source = source.description();
  baked.sky = source.sky();
  baked.sun = source.sun();
  baked.sun_wanted = options.sun.take_out || baked.sun.has_value();
  baked.stored_light = source.stored_light();
  const PrefilterOptions env = env_options(*baked.options.specular);
  const bool wants_env = options.containers.contains(Container::env);
  baked.env_is_specular = wants_env && env == *baked.options.specular;
  const bool second_chain = wants_env && !baked.env_is_specular;
  BakeMemory memory{baked.source.path, source.bytes(), 0, 0, env.size};
  source.visit([&](const auto& view) {
    memory.bake = bake_bytes(view, baked.options);
    if (second_chain) memory.second_bake = bake_bytes(view, second_bake_options(env));
  });
  check_memory(memory, options, baked.options);  // which holds the library's limit too
  const double end = second_chain ? kBaked : 1.0;
  baked.light = timed(baked.passes, "bake", "all that was asked for", [&] {
    return source.visit([&](const auto& view) { return bake(view, baked.options, part_of(control, kRead, end)); });
  });
  if (baked.stored_light) {
    timed(baked.passes, "stored light", "diffuse light as the input stores it, in full where its pixels are clipped",
          [&] { use_stored_light(baked, control); });
  }
  if (second_chain) {
    baked.env = timed(baked.passes, "specular for .env", "Babylon.js has a roughness of its own for each mip", [&] {
      return source.visit(
          [&](const auto& view) { return prefilter_specular(view, env, part_of(control, kBaked, 1.0)); });
    });
  }
  baked.picture = source.take_picture();
  if (wants_env) baked.env_mips = baked.env ? baked.env->mips : baked.light.specular->mips;
  return baked;
}

}  // namespace welkin::tool
