#pragma once

#include <vector>

namespace welkin::perf {

/// ProjectLatLong/FORMAT/4096x2048/THREADS.
void add_project_lat_long(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
