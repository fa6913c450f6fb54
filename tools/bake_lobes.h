// What `welkin bake --lobe` makes beside the specular cubemap: chains by other lobes than GGX.
#pragma once

#include <string>

#include "tools/bake_options.h"
#include "welkin/reflections.h"

namespace welkin::tool {

/// A chain that was asked for.
struct LobeChain {
  LobeFamily lobe = LobeFamily::charlie;
  PrefilteredSpecular light;
};

/// Returns what its file holds.
[[nodiscard]] std::string what_of(LobeFamily lobe);

/// Returns the chain's options. `specular`: of `library_options`.
[[nodiscard]] PrefilterOptions lobe_options(LobeFamily lobe, const BakeCommandOptions& options,
                                            const PrefilterOptions& specular);

/// Options of the octahedral map of such a chain, its border one texel of the last level: as many levels as have whole
/// texels and four of them at least.
[[nodiscard]] OctahedralOptions octahedral_of(int size, int chain_levels);

}  // namespace welkin::tool
