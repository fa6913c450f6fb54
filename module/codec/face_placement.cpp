#include "codec/face_placement.h"

#include <algorithm>
#include <string>

#include "welkin/error.h"

namespace welkin::codec {
namespace {

// {column, row} of +X -X +Y -Y +Z -Z.
constexpr CubePlacement kVerticalStrip{1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}};
constexpr CubePlacement kHorizontalStrip{6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}};
constexpr CubePlacement kHorizontalCross{4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}};
constexpr CubePlacement kVerticalCross{3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3, true, true}}}};
constexpr CubePlacement kOpenExrCube{1,
                                     6,
                                     {{{0, 0, true, false},
                                       {0, 1, true, false},
                                       {0, 2, false, true},
                                       {0, 3, false, true},
                                       {0, 4, true, false},
                                       {0, 5, true, false}}}};

}  // namespace

const CubePlacement& cube_placement(Layout layout) {
  switch (layout) {
    case Layout::vertical_strip:
    case Layout::six_files: return kVerticalStrip;
    case Layout::horizontal_strip: return kHorizontalStrip;
    case Layout::horizontal_cross: return kHorizontalCross;
    case Layout::vertical_cross: return kVerticalCross;
    case Layout::automatic:
    case Layout::lat_long: break;
  }
  throw Error(ErrorCode::invalid_argument,
              std::string("the layout ") + name(layout) + " has no faces; strips, crosses and six files have them");
}

const CubePlacement& openexr_cube_placement() noexcept { return kOpenExrCube; }

RowSegments row_segments(const CubePlacement& placement, int size, int picture_row) noexcept {
  RowSegments found;
  const int row_of_faces = picture_row / size;
  const int row = picture_row % size;
  for (int column = 0; column < placement.columns; ++column) {
    for (std::size_t face = 0; face < placement.faces.size(); ++face) {
      const FacePlacement& place = placement.faces[face];
      if (place.row != row_of_faces || place.column != column) continue;
      const int face_row = place.mirrored_rows ? size - 1 - row : row;
      found.segments[found.count++] = {static_cast<int>(face), face_row, column * size, place.mirrored_columns};
    }
  }
  return found;
}

void copy_segment(const float* from, float* to, int size, bool mirrored) noexcept {
  const auto floats = std::ptrdiff_t{3} * size;
  if (!mirrored) {
    std::copy_n(from, floats, to);
    return;
  }
  for (std::ptrdiff_t texel = 0; texel < floats; texel += 3) {
    std::copy_n(from + texel, 3, to + (floats - 3 - texel));
  }
}

}  // namespace welkin::codec
