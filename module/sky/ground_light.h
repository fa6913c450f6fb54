// What a view sees of the ground: how bright it is under any sun, and how much of that gets through.
#pragma once

#include <vector>

#include "sky/sky_colour.h"
#include "sky/table_mapping.h"
#include "welkin/sky_tables.h"

namespace welkin::sky {

/// Nodes over the square root of |mu_s| with mu_s' sign, from -1 to 1: dense about the horizon, where the disc sets.
inline constexpr int kGroundNodes = 513;

/// Radiance that leaves the ground at each of them, lit by the sun and by the sky: [kGroundNodes][4], the last 0.
[[nodiscard]] std::vector<float> ground_radiances(const SkyTables& tables, const TableMapping& mapping,
                                                  const ColourFold& fold);

/// Share of the ground's light that arrives at an altitude within the air, along the rays of the `half` view nodes that
/// end on the ground (of 2 half, as the mapping has them): [half][4], the last 0.
[[nodiscard]] std::vector<float> ground_reach(const SkyTables& tables, const TableMapping& mapping,
                                              const ColourFold& fold, double altitude, int half);

}  // namespace welkin::sky
