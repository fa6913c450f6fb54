#include "tools/preview_cross.h"

#include <algorithm>
#include <array>

namespace welkin::tool {
namespace {

constexpr glm::dvec3 kBackground(0.01, 0.01, 0.012);
constexpr int kLargestSampling = 16;

/// A cell of the cross: where it stands, and what its middle, its right and its upper edge look along.
struct Cell {
  int column, row;
  glm::dvec3 middle, right, up;
};

const std::array<Cell, 6> kCells = {{{1, 0, {0, 1, 0}, {-1, 0, 0}, {0, 0, -1}},
                                     {0, 1, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                     {1, 1, {0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},
                                     {2, 1, {-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                     {3, 1, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}},
                                     {1, 2, {0, -1, 0}, {-1, 0, 0}, {0, 0, 1}}}};

/// Draws the cross of one level with its upper left corner at (left, top).
void draw(PreviewPicture& picture, const CubeLookup& cube, int level, const ToneMap& tone_map, int cell, int left,
          int top) {
  const int sampling = std::clamp((cube.size(level) + cell - 1) / cell, 1, kLargestSampling);
  for (const Cell& each : kCells) {
    const int x = left + each.column * cell;
    const int y = top + each.row * cell;
    const auto shade = [&](double column, double row) {
      const double right = 2.0 * (column - x) / cell - 1.0;
      const double up = 1.0 - 2.0 * (row - y) / cell;
      return tone_map(cube.at(each.middle + right * each.right + up * each.up, level));
    };
    for (int row = y; row < y + cell; ++row) {
      for (int column = x; column < x + cell; ++column) {
        picture.set(column, row, supersampled(column, row, sampling, shade));
      }
    }
  }
}

/// The smallest level that has as many texels as a cell has pixels.
int level_for(const CubeLookup& cube, int cell) {
  int level = 0;
  while (level + 1 < cube.levels() && cube.size(level + 1) >= cell) ++level;
  return level;
}

}  // namespace

PreviewPicture preview_cross(const CubeLookup& environment, const ToneMap& tone_map, int cell) {
  PreviewPicture picture(4 * cell, 3 * cell, kBackground);
  draw(picture, environment, level_for(environment, cell), tone_map, cell, 0, 0);
  return picture;
}

PreviewPicture preview_mips(const CubeLookup& specular, const ToneMap& tone_map, int cell) {
  constexpr int kInARow = 4;
  const int gap = cell / 8;
  const int columns = std::min(specular.levels(), kInARow);
  const int rows = (specular.levels() + kInARow - 1) / kInARow;
  PreviewPicture picture(columns * (4 * cell + gap) - gap, rows * (3 * cell + gap) - gap, kBackground);
  for (int level = 0; level < specular.levels(); ++level) {
    draw(picture, specular, level, tone_map, cell, level % kInARow * (4 * cell + gap),
         level / kInARow * (3 * cell + gap));
  }
  return picture;
}

}  // namespace welkin::tool
