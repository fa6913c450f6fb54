#pragma once

#include <memory>
#include <vector>

#include "welkin/bake.h"
#include "welkin/image.h"

namespace welkin::perf {

/// A lat-long half as high as wide: a sky over ground with clouds of a few sizes, as smooth as photographs are and no
/// smoother; and a sun of 34 000, one degree across. The last one is kept.
[[nodiscard]] std::shared_ptr<const LatLongImage> bake_picture(int width, bool sun);

/// A chain of `size`, an irradiance cubemap and a BRDF table without sheen.
[[nodiscard]] BakeOptions bake_options(int size, bool background);

/// The whole chain of a 512 cubemap from a 1024 x 512 lat-long, others, and BRDF tables.
/// - Bake/512: cubemap (mip 0), prefiltered mips 1.., 64-texel irradiance, 64 x 64 BRDF table, into new memory; the
///   table from the cache. `-again`: into the memory of the last. `-cold-brdf`: the table is made each time.
///   `-background`: with a background cubemap of its own and its mips as well. `-sun`: of a picture with a sun.
///   Bake/N/WxH: a chain of N from W x H, into the memory of the last.
/// - BrdfTable/split_sum/64: made, without the cache; `-sheen` with the third channel.
void add_bakes(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
