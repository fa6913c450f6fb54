// What the sources of cubemaps with levels share: KTX2, DDS, .env.
#pragma once

#include "codec/row_source.h"

namespace welkin::codec {

/// Fills in layout and sizes for a file whose format says that it holds six faces: a vertical strip of the level that
/// was asked for. `size`: texels along an edge of level 0. Needs `info.path` and `info.format`. Throws `Error`:
/// unsupported_file for another layout, or a level that is not there.
void settle_cube(EnvironmentInfo& info, int size, int levels, const ReadOptions& options);

}  // namespace welkin::codec
