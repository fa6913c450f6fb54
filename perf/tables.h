#pragma once

#include <vector>

namespace welkin::perf {

/// TexelWeights and LatLongWeights, cold (built) and warm (from the cache).
void add_tables();

/// Tables by which path tracers pick directions, of a picture of 4096 x 2048, into memory that is there.
void add_importance(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
