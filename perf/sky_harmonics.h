#pragma once

#include <vector>

namespace welkin::perf {

/// Earth's sky to nine harmonics: SkyHarmonics (a projection), SkyCurve (at: ask, bake) and SkyLight (a frame's update
/// with a sun that moves).
void add_sky_harmonics(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
