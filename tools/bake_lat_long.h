// The lat-long among the files of a bake: the source's own pixels, or one direct resampling of them.
#pragma once

#include <cstdint>

#include "tools/bake_options.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::tool {

/// Returns the bytes of the lat-long; 0 if there is none. `whole`: from `library_options`.
[[nodiscard]] std::uint64_t lat_long_bytes(const SourceShape& source, const BakeCommandOptions& options,
                                           const BakeOptions& whole);

/// Returns the lat-long of a bake, without width if there is none. In an engine's folder, if no option names a size, it
/// is as large as the source, or four times as wide as a cubemap's face; else it is four times as wide as the
/// background cubemap. A lat-long source of that size keeps its pixels, except for those that the pixel policy changes.
[[nodiscard]] LatLongImage lat_long_of(const LatLongView& source, const BakeCommandOptions& options,
                                       const BakeOptions& whole, const Control& control);
[[nodiscard]] LatLongImage lat_long_of(const CubemapView& source, const BakeCommandOptions& options,
                                       const BakeOptions& whole, const Control& control);

}  // namespace welkin::tool
