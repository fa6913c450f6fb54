#include "env_file.h"

#include "chains.h"
#include "welkin/bake_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::wasm {

std::vector<std::byte> env_file(const Pixels& picture, const Options& options, int first, const PixelPolicy& policy,
                                const SphericalHarmonics& radiance, const Control& control) {
  PrefilterOptions chain;
  if (options.whole(first + kChainSize) != 0) chain.size = options.whole(first + kChainSize);
  require_edge("size", chain.size);
  chain.mips = full_chain_levels(chain.size);
  chain.roughness = roughness_of_mips(RoughnessSchedule::babylon, *chain.mips, chain.size);
  chain.lobe_roughness = fitted_roughness_of_mips(RoughnessSchedule::babylon, *chain.mips, chain.size);
  chain.pixels = policy;
  const PrefilteredSpecular made = picture.wide != nullptr ? prefilter_specular(*picture.wide, chain, control)
                                                           : prefilter_specular(*picture.cube, chain, control);
  std::vector<std::byte> bytes;
  write_babylon_environment({bytes, "environment.env"}, to_babylon(made.cubemap, radiance));
  return bytes;
}

}  // namespace welkin::wasm
