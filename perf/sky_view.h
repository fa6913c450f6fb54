// What it costs to look at a sky.
#pragma once

#include <vector>

namespace welkin::perf {

/// SkyRadiance, SkyView, SkyCubemap, SkyLatLong, SkySpecular.
void add_sky_views(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
