// Texels on the border of an octahedral map.
#pragma once

namespace welkin::octahedral {

/// Takes a texel of a border to the one inside whose copy it is: over an edge at its own distance, and mirrored along
/// it. `inner`: texels along an edge inside the border; column and row are counted from 0 there. A border may be wider
/// than the map inside. A texel that lies inside stays.
inline void move_inside(int inner, int& column, int& row) noexcept {
  const auto mirrored = [inner](int& across, int& along) {
    if (across >= 0 && across < inner) return false;
    across = across < 0 ? -1 - across : 2 * inner - 1 - across;
    along = inner - 1 - along;
    return true;
  };
  while (mirrored(column, row) || mirrored(row, column)) {
  }
}

}  // namespace welkin::octahedral
