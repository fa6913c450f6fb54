// How dense one kind of matter is at an altitude: the twin, in double, of what tables evaluate in lanes.
#pragma once

#include <span>
#include <vector>

#include "welkin/atmosphere.h"

namespace welkin::sky {

/// A layer covers altitudes from its bottom up to, not including, its top; the last one all above. No layers: 0.
/// Altitudes below 0 are taken as 0. From 0 to 1 for every profile that `check` accepts.
[[nodiscard]] double density(std::span<const DensityLayer> layers, double altitude_m) noexcept;

/// What one layer's formula gives at an altitude, its own or not, clamped to [0, 1].
[[nodiscard]] double density_of(const DensityLayer& layer, double altitude_m) noexcept;

/// Altitudes strictly between 0 and `thickness_m`, rising, at which the density or its slope jumps: tops of layers, and
/// places where a layer's formula meets 0 or 1. Between two of them the density is analytic. At most 7 + 8 * 4.
[[nodiscard]] std::vector<double> density_breaks(std::span<const DensityLayer> layers, double thickness_m);

/// Altitudes strictly between 0 and `thickness_m`, rising, at which the density may turn from rising to falling or back
/// inside of a layer. Between two of these or of the breaks it is monotone. At most 8.
[[nodiscard]] std::vector<double> density_turns(std::span<const DensityLayer> layers, double thickness_m);

}  // namespace welkin::sky
