#include "image/texel_grid.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>

#include "image/texel_geometry.h"

namespace welkin::image {

glm::dvec3 TexelGrid::direction(std::int64_t texel) const noexcept {
  const auto row = static_cast<int>(texel / columns_);
  const auto column = static_cast<int>(texel % columns_);
  if (kind_ == Kind::lat_long) return lat_long_direction(columns_, rows_, column + 0.5, row + 0.5);
  return face_direction(columns_, row / columns_, column + 0.5, row % columns_ + 0.5);
}

TexelGrid::Neighbours TexelGrid::neighbours(std::int64_t texel) const noexcept {
  const auto row = static_cast<int>(texel / columns_);
  const auto column = static_cast<int>(texel % columns_);
  const int face = row / columns_;
  const int face_row = row % columns_;
  Neighbours result;
  for (int down = -1; down <= 1; ++down) {
    for (int right = -1; right <= 1; ++right) {
      if (down == 0 && right == 0) continue;
      if (kind_ == Kind::lat_long) {
        result.add(on_lat_long(row + down, column + right));
        continue;
      }
      const bool off_row = face_row + down < 0 || face_row + down >= columns_;
      const bool off_column = column + right < 0 || column + right >= columns_;
      if (off_row && off_column) continue;  // three faces meet here: nothing lies across the corner
      result.add(on_cubemap(face, face_row + down, column + right));
    }
  }
  return result;
}

std::int64_t TexelGrid::on_lat_long(int row, int column) const noexcept {
  if (row < 0 || row >= rows_) {
    row = std::clamp(row, 0, rows_ - 1);
    column += columns_ / 2;
  }
  return std::int64_t{row} * columns_ + (column + columns_) % columns_;
}

// A cube of edge 2N with its middle at the origin has texel centres at whole numbers. A place one step past an edge
// is folded down: what it is beyond N along the face, it lies below N along the face's normal.
std::int64_t TexelGrid::on_cubemap(int face, int row, int column) const noexcept {
  const double edge = columns_;
  double u = 2.0 * column + 1.0 - edge;
  double v = 2.0 * row + 1.0 - edge;
  double along_normal = edge;
  for (double* coordinate : {&u, &v}) {
    if (*coordinate >= -edge && *coordinate <= edge) continue;
    along_normal = edge - (*coordinate < 0.0 ? -*coordinate - edge : *coordinate - edge);
    *coordinate = *coordinate < 0.0 ? -edge : edge;
  }
  const Frame& from = face_frame(face);
  const glm::dvec3 place = u * from.u + v * from.v + along_normal * from.normal;
  int to = 0;
  while (to < 5 && glm::dot(place, face_frame(to).normal) != edge) ++to;
  const auto index = [&](const glm::dvec3& axis) {
    return static_cast<int>((glm::dot(place, axis) + edge - 1.0) / 2.0);
  };
  const int new_row = index(face_frame(to).v);
  const int new_column = index(face_frame(to).u);
  return (std::int64_t{to} * columns_ + new_row) * columns_ + new_column;
}

int TexelGrid::row_classes() const noexcept { return kind_ == Kind::lat_long ? rows_ : (columns_ + 1) / 2; }

int TexelGrid::class_of(int row) const noexcept {
  if (kind_ == Kind::lat_long) return row;
  return std::min(row % columns_, columns_ - 1 - row % columns_);
}

TexelGrid::Rows TexelGrid::rows_of(int row_class) const noexcept {
  Rows result;
  const auto add = [&](int row) { result.rows[static_cast<std::size_t>(result.count++)] = row; };
  if (kind_ == Kind::lat_long) {
    add(row_class);
    return result;
  }
  for (int face = 0; face < 6; ++face) {
    add(face * columns_ + row_class);
    if (columns_ - 1 - row_class != row_class) add(face * columns_ + columns_ - 1 - row_class);
  }
  return result;
}

void TexelGrid::solid_angles(int row_class, std::span<double> steradians) const {
  if (kind_ == Kind::cubemap) return cubemap_row_solid_angles(row_class, steradians);
  std::fill(steradians.begin(), steradians.end(), lat_long_texel_solid_angle(columns_, rows_, row_class));
}

std::vector<double> solid_angles_of(const TexelGrid& grid, const std::vector<std::int64_t>& texels) {
  std::vector<double> result;
  std::vector<double> row_angles(static_cast<std::size_t>(grid.columns()));
  std::int64_t known_row = -1;
  for (const std::int64_t texel : texels) {
    const std::int64_t row = texel / grid.columns();
    if (row != known_row) grid.solid_angles(grid.class_of(static_cast<int>(row)), row_angles);
    known_row = row;
    result.push_back(row_angles[static_cast<std::size_t>(texel % grid.columns())]);
  }
  return result;
}

}  // namespace welkin::image
