// Cubemaps unfolded, as who stands in them sees them.
#pragma once

#include "tools/cube_lookup.h"
#include "tools/preview_picture.h"
#include "tools/tone_map.h"

namespace welkin::tool {

/// A cross as seen from inside, facing +z: left (+x), front (+z), right (-x) and back (-z) in a row, up above the front
/// and down below it. What is written there reads as it should. (A cubemap's own faces look mirrored:
/// docs/orientation.md says why.) `cell`: pixels along a face's edge.
[[nodiscard]] PreviewPicture preview_cross(const CubeLookup& environment, const ToneMap& tone_map, int cell = 256);

/// Every mip as a cross of its own, all of one size, in rows of four from the sharpest to the roughest; a texel is
/// spread over many pixels as a graphics card spreads it, so that seams would show.
[[nodiscard]] PreviewPicture preview_mips(const CubeLookup& specular, const ToneMap& tone_map, int cell = 64);

}  // namespace welkin::tool
