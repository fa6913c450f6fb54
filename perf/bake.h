#pragma once

#include <vector>

namespace welkin::perf {

/// The whole chain of a 512 cubemap from a 1024 x 512 lat-long, and BRDF tables.
/// - Bake/512: cubemap (mip 0), prefiltered mips 1.., 64-texel irradiance, 64 x 64 BRDF table, into new memory; the
///   table from the cache. `-again`: into the memory of the last. `-cold-brdf`: the table is made each time.
///   `-background`: with a background cubemap of its own and its mips as well. `-sun`: of a picture with a sun.
/// - BrdfTable/split_sum/64: made, without the cache; `-sheen` with the third channel.
void add_bakes(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
