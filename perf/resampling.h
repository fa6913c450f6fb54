// Passes that copy light from one shape to another, beside plain copying.
#pragma once

#include <vector>

namespace welkin::perf {

void add_resampling(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
