#include "image/geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/resampling.h"

namespace welkin::image {
namespace {

constexpr std::array<Frame, 6> kFaces{{
    {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}},
    {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
    {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
    {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
}};

}  // namespace

const Frame& face_frame(int face) noexcept { return kFaces[static_cast<std::size_t>(face)]; }

glm::dvec3 face_direction(int size, int face, double column, double row) noexcept {
  const Frame& frame = face_frame(face);
  const double u = 2.0 * column / size - 1.0;
  const double v = 2.0 * row / size - 1.0;
  return (frame.normal + u * frame.u + v * frame.v) / std::sqrt(1.0 + u * u + v * v);
}

glm::dvec3 lat_long_direction(int width, int height, double column, double row) noexcept {
  const math::SineCosine latitude = math::sine_cosine_of_turns(0.25 - row / (2.0 * height));
  const math::SineCosine longitude = math::sine_cosine_of_turns(0.5 - column / width);
  return {longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine};
}

// The integral of cos(latitude) over the texel is 2 pi / width (sin(top) - sin(bottom)); with the row's
// polar angle theta at its centre that difference is the product 2 sin(theta) sin(pi / (2 height)).
double lat_long_texel_solid_angle(int width, int height, int row) {
  const double polar_sine = math::sine_cosine_of_turns((row + 0.5) / (2.0 * height)).sine;
  return 2.0 * std::numbers::pi / width * 2.0 * polar_sine * math::sine_cosine_of_turns(0.25 / height).sine;
}

double cubemap_texel_solid_angle(int size, int row, int column) {
  const double half_edge = 1.0 / static_cast<double>(size);
  // Mirrored columns give the same u, so both halves of a row have the same bits.
  const double u = (2.0 * std::min(column, size - 1 - column) + 1.0) * half_edge - 1.0;
  const double v = (2.0 * row + 1.0) * half_edge - 1.0;
  return math::rectangle_solid_angle(u, v, half_edge, half_edge, math::texel_rule(size));
}

void cubemap_row_solid_angles(int row, std::span<double> row_angles) {
  const auto size = static_cast<int>(row_angles.size());
  for (int column = 0; column < (size + 1) / 2; ++column) {
    row_angles[static_cast<std::size_t>(column)] = row_angles[static_cast<std::size_t>(size - 1 - column)] =
        cubemap_texel_solid_angle(size, row, column);
  }
}

std::shared_ptr<const FaceSolidAngles> FaceSolidAngles::get(int size) {
  constexpr std::size_t kept = std::size_t{8} << 20U;                      // faces of up to 2048
  static auto& cache = *new math::TableCache<int, FaceSolidAngles>(kept);  // never destroyed
  return cache.get(size, [&] { return std::make_shared<const FaceSolidAngles>(size); });
}

FaceSolidAngles::FaceSolidAngles(int size) : size_(size) {
  // A texel's half-width is 1 / size and the integrand's poles are at distance 1, so k points are off like
  // (2 size)^(-2k). Computed against 12 points: 3e-14 for size 32 with 4, 1.5e-12 for 64 with 3 and 5e-12 for 512 with
  // 2, relative.
  const auto order_for = [](int texels) { return texels < 64 ? 4 : (texels < 512 ? 3 : 2); };
  const math::GaussRule rule = size < 32 ? math::texel_rule(size) : math::gauss_legendre(order_for(size));
  const int half = (size + 1) / 2;
  const double half_edge = 1.0 / size;
  const auto index = [half](int row, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(half) + static_cast<std::size_t>(column);
  };
  quadrant_.resize(index(half, 0));
  for (int row = 0; row < half; ++row) {
    const double v = (2.0 * row + 1.0) * half_edge - 1.0;
    // The density is symmetric in u and v: half of the quadrant is enough.
    for (int column = 0; column <= row; ++column) {
      const double u = (2.0 * column + 1.0) * half_edge - 1.0;
      quadrant_[index(row, column)] = quadrant_[index(column, row)] =
          math::rectangle_solid_angle(u, v, half_edge, half_edge, rule);
    }
  }
}

namespace {

struct WholeFrame {
  glm::ivec3 u;
  glm::ivec3 v;
  glm::ivec3 normal;
};

const WholeFrame& whole_frame(int face) {
  static const std::array<WholeFrame, 6> frames = [] {
    std::array<WholeFrame, 6> result{};
    for (int i = 0; i < 6; ++i) {
      const Frame& frame = face_frame(i);
      result[static_cast<std::size_t>(i)] = {glm::ivec3(frame.u), glm::ivec3(frame.v), glm::ivec3(frame.normal)};
    }
    return result;
  }();
  return frames[static_cast<std::size_t>(face)];
}

int dot(const glm::ivec3& a, const glm::ivec3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

}  // namespace

int face_of(const glm::dvec3& direction) noexcept {
  const double x = std::abs(direction.x);
  const double y = std::abs(direction.y);
  const double z = std::abs(direction.z);
  if (x >= y && x >= z) return direction.x < 0.0 ? 1 : 0;
  if (y >= z) return direction.y < 0.0 ? 3 : 2;
  return direction.z < 0.0 ? 5 : 4;
}

glm::ivec3 point_of(int size, const CubeTexel& texel) noexcept {
  const WholeFrame& frame = whole_frame(texel.face);
  // The unit is half a texel, so centres (odd places from the edge) are whole numbers and every symmetry of the cube
  // maps them without rounding.
  return frame.normal * size + frame.u * (2 * texel.column + 1 - size) + frame.v * (2 * texel.row + 1 - size);
}

CubeTexel texel_at(int size, const glm::ivec3& point) noexcept {
  int face = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(point[axis]) == size) face = 2 * axis + (point[axis] < 0 ? 1 : 0);
  }
  const WholeFrame& frame = whole_frame(face);
  return {face, (dot(point, frame.u) + size - 1) / 2, (dot(point, frame.v) + size - 1) / 2};
}

// The point lies half a texel beyond the edge, on the face's plane: folded over the edge it lies half a texel down the
// neighbour.
CubeTexel across_edge(int size, const CubeTexel& outside) noexcept {
  const WholeFrame& frame = whole_frame(outside.face);
  glm::ivec3 point = point_of(size, outside);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(point[axis]) > size) {
      point[axis] = point[axis] < 0 ? -size : size;
    } else if (frame.normal[axis] != 0) {
      point[axis] -= frame.normal[axis];
    }
  }
  return texel_at(size, point);
}

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
      const CubeTexel beside{face, column + right, face_row + down};
      result.add(on_cubemap(off_row || off_column ? across_edge(columns_, beside) : beside));
    }
  }
  return result;
}

std::int64_t TexelGrid::on_lat_long(int row, int column) const noexcept {
  if (row < 0 || row >= rows_) {
    row = std::clamp(row, 0, rows_ - 1);
    // The meridian opposite. An odd width has no column there, and half a column less is taken.
    column += columns_ / 2;
  }
  return std::int64_t{row} * columns_ + (column + columns_) % columns_;
}

std::int64_t TexelGrid::on_cubemap(const CubeTexel& texel) const noexcept {
  return (std::int64_t{texel.face} * columns_ + texel.row) * columns_ + texel.column;
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
  result.reserve(texels.size());
  const bool cubemap = grid.kind() == TexelGrid::Kind::cubemap;
  int known_row = -1;
  for (const std::int64_t texel : texels) {
    const auto row = static_cast<int>(texel / grid.columns());
    if (cubemap) {
      const auto column = static_cast<int>(texel % grid.columns());
      result.push_back(cubemap_texel_solid_angle(grid.columns(), grid.class_of(row), column));
    } else {
      result.push_back(row == known_row ? result.back() : lat_long_texel_solid_angle(grid.columns(), grid.rows(), row));
    }
    known_row = row;
  }
  return result;
}

}  // namespace welkin::image

namespace welkin {

glm::dmat3 rotation_about_y(double degrees) {
  const platform::FloatingPointScope floating_point;
  if (!(std::abs(degrees) <= 1e6)) {
    throw Error(ErrorCode::invalid_argument,
                "a turn of " + platform::number_text(degrees) + " degrees about y; it must be within 1e6 degrees");
  }
  const math::SineCosine rotation = math::sine_cosine_of_turns(degrees / 360.0);
  // Columns are where x, y and z go: x towards -z and z towards x, which is right-handed about +y.
  return {glm::dvec3(rotation.cosine, 0.0, -rotation.sine), glm::dvec3(0.0, 1.0, 0.0),
          glm::dvec3(rotation.sine, 0.0, rotation.cosine)};
}

}  // namespace welkin
