// What `welkin bake --lobe` makes beside the specular cubemap: chains by other lobes than GGX.
#pragma once

#include <string>
#include <vector>

#include "tools/bake_options.h"
#include "welkin/core.h"
#include "welkin/zonal_kernel.h"

namespace welkin::tool {

/// A chain that was asked for.
struct LobeChain {
  Lobe lobe = Lobe::charlie;
  PrefilteredSpecular light;
};

/// What its file holds.
[[nodiscard]] std::string what_of(Lobe lobe);

/// Size of mip 0 and a kernel a mip. `specular`: of `library_options`.
[[nodiscard]] KernelChainOptions kernels_of(Lobe lobe, const BakeCommandOptions& options,
                                            const PrefilterOptions& specular);

/// Options of the octahedral map of such a chain, its border one texel of the last level: as many levels as have whole
/// texels and four of them at least.
[[nodiscard]] OctahedralOptions octahedral_of(int size, int chain_levels);

}  // namespace welkin::tool
