#include "light.h"

#include <memory>
#include <utility>
#include <vector>

#include "welkin/bake.h"
#include "welkin/engines.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::wasm {
namespace {

std::vector<double> polynomial_numbers(const BabylonPolynomial& p) {
  std::vector<double> numbers;
  for (const dvec3& term : {p.x, p.y, p.z, p.xx, p.yy, p.zz, p.yz, p.zx, p.xy}) {
    numbers.insert(numbers.end(), {term.x, term.y, term.z});
  }
  return numbers;
}

/// All mips of a cubemap as they are: packed RGB floats, mip by mip, face by face.
void give_floats(Cubemap cubemap) {
  const auto kept = std::make_shared<const Cubemap>(std::move(cubemap));
  results().push_back({kept->pixels().data(), kept->bytes(), kept});
}

/// The chain of an .env file, which has mips of its own, all down to one texel.
Cubemap env_chain(const LatLongView* wide, const CubemapView* cube, const Options& options, int first,
                  const PixelPolicy& policy, const Control& control) {
  PrefilterOptions chain;
  if (options.whole(first + kChainSize) != 0) chain.size = options.whole(first + kChainSize);
  require_edge("size", chain.size);
  chain.mips = full_chain_levels(chain.size);
  chain.use_schedule(RoughnessSchedule::babylon, true);
  chain.pixels = policy;
  return (wide != nullptr ? prefilter_specular(*wide, chain, control) : prefilter_specular(*cube, chain, control))
      .cubemap;
}

void give_light(BakeResult light, const Options& options, int first, Cubemap env) {
  const auto nothing = [] { results().emplace_back(); };
  give(*light.radiance);
  const dmat3& into_babylon = convention(Engine::babylon).from_welkin;
  give(polynomial_numbers(light.stored_polynomial ? *light.stored_polynomial
                                                  : babylon_polynomial(rotate(*light.radiance, into_babylon))));
  const bool floats = options.flag(first + kChainFloats);
  if (light.specular && options.flag(first + kLightTexels)) {
    give_chain(*light.specular, floats);
  } else if (light.specular) {
    give_numbers(*light.specular);
    nothing();
  } else {
    nothing();
    nothing();
  }
  give_floats(std::move(env));
  if (light.specular && options.flag(first + kLightKtx2)) {
    give_floats(std::move(light.specular->cubemap));
  } else {
    nothing();
  }
  if (light.background) {
    give_texels(*light.background, floats);
  } else {
    nothing();
  }
}

BakeOptions bake_options(const Options& options, int first, const PixelPolicy& pixels) {
  BakeOptions wanted;
  wanted.background.reset();
  wanted.irradiance.reset();
  wanted.brdf.reset();
  wanted.bands = options.whole(first + kLightBands);
  wanted.pixels = pixels;
  wanted.memory_limit_bytes = kMaxBytes;
  if (options.flag(first + kLightTexels) || options.flag(first + kLightKtx2)) {
    wanted.specular = prefilter_options(options, first);
  } else {
    wanted.specular.reset();
  }
  if (options.whole(first + kLightBackground) > 0) {
    require_edge("background.size", options.whole(first + kLightBackground));
    wanted.background = BackgroundOptions{.size = options.whole(first + kLightBackground), .mips = false};
  }
  return wanted;
}

}  // namespace

Control part(double from, double to) {
  Control whole = reporting();
  Control part;
  part.progress = [report = whole.progress, from, to](double share) { report(from + (to - from) * share); };
  return part;
}

void bake_pixels(const LatLongView* wide, const CubemapView* cube, const Options& options, int first,
                 const PixelPolicy& pixels, double from) {
  const bool env = options.flag(first + kLightEnv);
  const BakeOptions wanted = bake_options(options, first, pixels);
  const double middle = env ? from + 0.5 * (1.0 - from) : 1.0;
  BakeResult light =
      wide != nullptr ? bake(*wide, wanted, part(from, middle)) : bake(*cube, wanted, part(from, middle));
  Cubemap chain;
  if (env) chain = env_chain(wide, cube, options, first, pixels, part(middle, 1.0));
  give_light(std::move(light), options, first, std::move(chain));
}

}  // namespace welkin::wasm
