// Grids of probes: baked from memory and from files, relit, packed, looked up.
#pragma once

#include <vector>

namespace welkin::perf {

/// Benchmarks Probes/VARIANT/64x10000/threads.
void add_probes(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
