// The lat-long among the files of a bake: the source's own pixels, or one direct resampling of them.
#pragma once

#include <cstdint>

#include "tools/bake_options.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/plan.h"

namespace welkin::tool {

/// What it takes in memory; 0: there is none. `whole`: of `library_options`.
[[nodiscard]] std::uint64_t lat_long_bytes(const SourceShape& source, const BakeCommandOptions& options,
                                           const BakeOptions& whole);

/// In an engine's folder it is as large as the source, of a cubemap four times as wide as a face, where no option names
/// a size; else four times as wide as the background cubemap. A lat-long source of that size gives its pixels as they
/// are, but for those that the pixel policy changes. Without width if there is none.
[[nodiscard]] LatLongImage lat_long_of(const LatLongView& source, const BakeCommandOptions& options,
                                       const BakeOptions& whole, const Control& control);
[[nodiscard]] LatLongImage lat_long_of(const CubemapView& source, const BakeCommandOptions& options,
                                       const BakeOptions& whole, const Control& control);

}  // namespace welkin::tool
