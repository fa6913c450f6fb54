// Parts of a bake that the command makes itself: its lat-long, chains by other lobes than GGX, and how much of the
// light lies beyond what a file's format holds.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>

#include "tools/bake_options.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"
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

/// Returns the bytes of the lat-long; 0 if there is none. `whole`: from `library_options`.
[[nodiscard]] std::uint64_t lat_long_bytes(const SourceShape& source, const BakeCommandOptions& options,
                                           const BakeOptions& whole);

/// Returns the lat-long of a bake, without width if there is none. In an engine's folder, if no option names a size, it
/// is as large as the source, or four times as wide as a cubemap's face; else it is four times as wide as the
/// background cubemap. A lat-long source of that size keeps its pixels, except for those that the pixel policy changes.
[[nodiscard]] LatLongImage lat_long_of(const EnvironmentView& source, const BakeCommandOptions& options,
                                       const BakeOptions& whole, const Control& control);

/// Returns the light that a clamp at `largest` takes away as a share of all luminance, by solid angle; 0 if there is no
/// light. Pixels are RGB floats; negative values count as no light.
[[nodiscard]] double share_beyond(const LatLongView& picture, const glm::dvec3& largest);
[[nodiscard]] double share_beyond(const CubemapView& cubemap, const glm::dvec3& largest);

}  // namespace welkin::tool
