#pragma once

#include <vector>

namespace welkin::perf {

/// ReadBandwidth/FORMAT/SIZE/THREADS for cubemaps of each size, and for a lat-long of 4096 x 2048.
void add_read_bandwidth(const std::vector<int>& sizes, const std::vector<int>& thread_counts);

}  // namespace welkin::perf
