#include "tools/bake_lobes.h"

namespace welkin::tool {

std::string what_of(LobeFamily lobe) {
  if (lobe == LobeFamily::charlie) return "prefiltered for sheen by Charlie's lobe, one roughness per mip";
  if (lobe == LobeFamily::lambert) return "prefiltered by the cosine lobe: irradiance over pi";
  return "prefiltered by Phong's lobe, a power a mip";
}

PrefilterOptions lobe_options(LobeFamily lobe, const BakeCommandOptions& options, const PrefilterOptions& specular) {
  PrefilterOptions chain = specular;
  chain.lobe = lobe;
  chain.lobe_roughness.clear();
  if (lobe == LobeFamily::phong) return chain;
  chain.mips.reset();
  chain.roughness.clear();
  if (lobe == LobeFamily::lambert)
    chain.size = options.irradiance_size > 0 ? options.irradiance_size : IrradianceOptions().size;
  return chain;
}

OctahedralOptions octahedral_of(int size, int chain_levels) {
  OctahedralOptions options{.size = size};
  while (options.levels < chain_levels && size % (2 << (options.levels - 1)) == 0 && (size >> options.levels) >= 4)
    ++options.levels;
  return options;
}

}  // namespace welkin::tool
