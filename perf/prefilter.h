#pragma once

#include <vector>

namespace welkin::perf {

/// Prefilter/METHOD/SIZE/THREADS: the whole chain of a cubemap, roughness k / (mips - 1), from a 1024 x 512 lat-long of
/// noise; and Prefilter/spectral-bright, the same with a sun of 1e6 in one texel. Sampled: importance sampling by 64
/// samples, which is not the library's. Sheen is a chain of five Charlie lobes. Octahedral/chain/SIZE/THREADS: five
/// levels of a map of so many texels.
void add_prefilter(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
