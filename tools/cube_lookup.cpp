#include "tools/cube_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace welkin::tool {
namespace {

/// A face's frame, as `CubemapView` has them: a direction on it is normal + u right + v down.
struct Frame {
  glm::dvec3 normal, right, down;
};

const std::array<Frame, 6> kFrames = {{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                       {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                       {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                       {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                       {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                       {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};

/// Where a direction meets the cube.
struct Place {
  std::size_t face;
  double u, v;  ///< in [-1, 1]
};

double dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Place place_of(const glm::dvec3& direction) {
  const double x = std::abs(direction.x);
  const double y = std::abs(direction.y);
  const double z = std::abs(direction.z);
  std::size_t face = 0;
  double along = x;
  if (x >= y && x >= z) {
    face = direction.x > 0.0 ? 0 : 1;
  } else if (y >= z) {
    face = direction.y > 0.0 ? 2 : 3;
    along = y;
  } else {
    face = direction.z > 0.0 ? 4 : 5;
    along = z;
  }
  return {face, dot(direction, kFrames[face].right) / along, dot(direction, kFrames[face].down) / along};
}

glm::dvec3 texel(const CubemapView& level, std::size_t face, int column, int row) {
  const auto* const values = static_cast<const float*>(level.faces[face]);
  const float* const rgb = values + (std::ptrdiff_t{row} * level.size + column) * 3;
  return {rgb[0], rgb[1], rgb[2]};
}

int nearest(double u, int size) { return std::clamp(static_cast<int>((u + 1.0) * 0.5 * size), 0, size - 1); }

/// A texel that may lie one beyond the face's edge: it is then the neighbour's, and at a corner, where three faces
/// meet and there is no fourth texel, the mean of the three.
glm::dvec3 texel_or_neighbour(const CubemapView& level, std::size_t face, int column, int row) {
  const int size = level.size;
  const int inner_column = std::clamp(column, 0, size - 1);
  const int inner_row = std::clamp(row, 0, size - 1);
  if (column == inner_column && row == inner_row) return texel(level, face, column, row);
  if (column != inner_column && row != inner_row) {
    return (texel(level, face, inner_column, inner_row) + texel_or_neighbour(level, face, column, inner_row) +
            texel_or_neighbour(level, face, inner_column, row)) /
           3.0;
  }
  const Frame& frame = kFrames[face];
  const double u = (2.0 * column + 1.0) / size - 1.0;
  const double v = (2.0 * row + 1.0) / size - 1.0;
  const Place place = place_of(frame.normal + u * frame.right + v * frame.down);
  return texel(level, place.face, nearest(place.u, size), nearest(place.v, size));
}

}  // namespace

glm::dvec3 CubeLookup::at(const glm::dvec3& direction, int level) const {
  const CubemapView& view = levels_[static_cast<std::size_t>(std::clamp(level, 0, levels() - 1))];
  const Place place = place_of(direction);
  const double x = (place.u + 1.0) * 0.5 * view.size - 0.5;
  const double y = (place.v + 1.0) * 0.5 * view.size - 0.5;
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  const double right = x - column;
  const double below = y - row;
  const auto get = [&](int i, int j) { return texel_or_neighbour(view, place.face, column + i, row + j); };
  return (1.0 - below) * ((1.0 - right) * get(0, 0) + right * get(1, 0)) +
         below * ((1.0 - right) * get(0, 1) + right * get(1, 1));
}

glm::dvec3 CubeLookup::at(const glm::dvec3& direction, double level) const {
  const double clamped = std::clamp(level, 0.0, static_cast<double>(levels() - 1));
  const int sharper = static_cast<int>(clamped);
  const double share = clamped - sharper;
  if (share == 0.0) return at(direction, sharper);
  return (1.0 - share) * at(direction, sharper) + share * at(direction, sharper + 1);
}

}  // namespace welkin::tool
