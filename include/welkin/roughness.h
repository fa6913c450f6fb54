// Which roughness each mip of a specular cubemap has, and where a shader looks for a roughness.
//
// Roughness is perceptual (what artists set) everywhere here; GGX's alpha is its square.
#pragma once

#include <vector>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// Named ways to spread roughness over a chain, t = mip / (mips - 1) in [0, 1].
enum class RoughnessSchedule {
  linear,    ///< t (glTF-IBL-Sampler)
  filament,  ///< 1 - sqrt(1 - t) (Filament, three.js)
  babylon,   ///< 0 at mip 0, else alpha = 2^(mip / 0.8) / size, at most 1 (Babylon.js, lodGenerationScale 0.8)
};

/// "linear", "filament", "babylon"
[[nodiscard]] const char* name(RoughnessSchedule schedule) noexcept;

/// Roughness of each of `mips` mips of a chain whose mip 0 has `size` texels along an edge: rising, in [0, 1], 0 at mip
/// 0. Throws `Error` (invalid_argument) unless 1 <= mips <= 16 and size >= 1.
[[nodiscard]] std::vector<double> roughness_of_mips(RoughnessSchedule schedule, int mips, int size);

/// The mip, fractions too, at which a shader that interpolates between mips finds `roughness`: by linear interpolation
/// in `table`, which must rise. Clamped to the table's ends. Throws `Error` (invalid_argument) for an empty table or
/// one that does not rise.
[[nodiscard]] double mip_of_roughness(const std::vector<double>& table, double roughness);

}  // namespace welkin
