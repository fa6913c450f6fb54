#include "tools/bake_lobes.h"

#include <algorithm>

namespace welkin::tool {
namespace {

/// The sharpest lobe that a Phong chain has: below, its power would ask for too many harmonics.
constexpr double kLeastPhongRoughness = 0.12;

/// As wide as GGX at that roughness: 2 / alpha^2 - 2 (Walter et al. 2007), but 1 at least, which is Lambert's.
double phong_power(double roughness) {
  const double alpha = std::max(roughness, kLeastPhongRoughness) * std::max(roughness, kLeastPhongRoughness);
  return std::max(1.0, 2.0 / (alpha * alpha) - 2.0);
}

}  // namespace

std::string what_of(Lobe lobe) {
  switch (lobe) {
    case Lobe::charlie: return "prefiltered for sheen by Charlie's lobe, a roughness a mip";
    case Lobe::lambert: return "prefiltered by the cosine: irradiance over pi";
    case Lobe::phong: break;
  }
  return "prefiltered by Phong's lobe, a power a mip";
}

KernelChainOptions kernels_of(Lobe lobe, const BakeCommandOptions& options, const PrefilterOptions& specular) {
  KernelChainOptions chain;
  chain.size = specular.size;
  chain.pixels = specular.pixels;
  chain.rms_error = specular.rms_error;
  if (lobe == Lobe::lambert) {
    chain.size = options.irradiance_size > 0 ? options.irradiance_size : IrradianceOptions().size;
    chain.kernels.push_back(ZonalKernel::lambert());
  } else if (lobe == Lobe::charlie) {
    const int mips = mips_of_chain(RoughnessSchedule::linear, specular.size);
    for (const double roughness : charlie_roughness_of_mips(mips, specular.size))
      chain.kernels.push_back(ZonalKernel::charlie(roughness));
  } else {
    for (const double roughness : specular.roughness)
      chain.kernels.push_back(ZonalKernel::phong(phong_power(roughness)));
  }
  return chain;
}

OctahedralOptions octahedral_of(int size, int chain_levels) {
  OctahedralOptions options{.size = size};
  while (options.levels < chain_levels && size % (2 << (options.levels - 1)) == 0 && (size >> options.levels) >= 4)
    ++options.levels;
  return options;
}

}  // namespace welkin::tool
