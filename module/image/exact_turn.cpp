#include "image/exact_turn.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "image/geometry.h"
#include "image/pixels.h"
#include "image/resampling.h"
#include "jobs/tiles.h"
#include "math/elementary.h"

namespace welkin::image {
namespace {

constexpr double kMatrixTolerance = 1e-9;
constexpr double kColumnTolerance = 1e-6;
constexpr int kTileTexels = 16384;

bool is_near(double value, double wanted) { return std::abs(value - wanted) <= kMatrixTolerance; }

using WholeMatrix = glm::mat<3, 3, int>;

std::optional<WholeMatrix> signed_permutation(const glm::dmat3& turn) {
  WholeMatrix result(0);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double whole = std::round(turn[column][row]);
      if (!is_near(turn[column][row], whole)) return {};
      result[column][row] = static_cast<int>(whole);
    }
  }
  return result;
}

/// Where a lat-long's columns and rows come from.
struct ColumnsAndRows {
  bool rows_reversed = false;
  bool columns_reversed = false;
  int shift = 0;  // column i of the source becomes i - shift, or width - 1 - i - shift; from 0 to width - 1

  [[nodiscard]] int source_column(int column, int width) const {
    const int moved = (column + shift) % width;
    return columns_reversed ? (width - 1 - moved) : moved;
  }
};

/// A longitude, in turns, becomes shift + itself, or shift - itself if the picture is mirrored: the columns move left
/// by shift times the width.
std::optional<ColumnsAndRows> columns_and_rows(const glm::dmat3& turn, int width) {
  const glm::dvec3 up = turn * glm::dvec3(0, 1, 0);
  if (!is_near(std::abs(up.y), 1.0) || !is_near(up.x, 0.0) || !is_near(up.z, 0.0)) return {};
  const glm::dvec3 ahead = turn * glm::dvec3(0, 0, 1);
  const glm::dvec3 left = turn * glm::dvec3(1, 0, 0);
  const double shift = math::turns_of(ahead.x, ahead.z) * width;
  const double whole = std::round(shift);
  if (std::abs(shift - whole) > kColumnTolerance) return {};
  const int moved = static_cast<int>(whole) % width;
  return ColumnsAndRows{up.y < 0.0, ahead.z * left.x - ahead.x * left.z < 0.0, moved < 0 ? moved + width : moved};
}

/// Calls `move(row)` for each of so many rows, several at a time.
template <typename Move>
void for_each_row(int rows, int width, const Control& control, const Move& move) {
  const int tile_rows = std::max(1, kTileTexels / width);
  const jobs::Placement where = jobs::placement_for(static_cast<std::int64_t>(rows) * width);
  const int tiles = (rows + tile_rows - 1) / tile_rows;
  jobs::run_tiles(static_cast<std::size_t>(tiles), where, jobs::worker_count(where), control,
                  [&](std::size_t tile, std::size_t) {
                    const int first = static_cast<int>(tile) * tile_rows;
                    for (int row = first; row < std::min(rows, first + tile_rows); ++row) move(row);
                  });
}

}  // namespace

bool is_cube_symmetry(const glm::dmat3& turn) noexcept { return signed_permutation(turn).has_value(); }

std::optional<CubemapImage> turned_exactly(const CubemapView& source, const glm::dmat3& turn, const Control& control) {
  const std::optional<WholeMatrix> forward = signed_permutation(turn);
  if (!forward) return {};
  const WholeMatrix& matrix = *forward;
  const int size = source.size;
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(size);
  CubemapImage result{size, std::vector<float>(6 * row_floats * static_cast<std::size_t>(size))};
  for_each_row(6 * size, size, control, [&](int strip_row) {
    float* rgb = result.pixels.data() + static_cast<std::size_t>(strip_row) * row_floats;
    const std::size_t texel_bytes = bytes_per_texel(source.format);
    for (int column = 0; column < size; ++column, rgb += 3) {
      const glm::ivec3 point = point_of(size, {strip_row / size, column, strip_row % size});
      const CubeTexel from = texel_at(size, point * matrix);  // the inverse: the transpose from the left
      const auto* row = static_cast<const std::byte*>(row_of(source, from.face, from.row));
      decode_texels(source.format, row + static_cast<std::size_t>(from.column) * texel_bytes, 1, rgb);
    }
  });
  return result;
}

std::optional<LatLongImage> turned_exactly(const LatLongView& source, const glm::dmat3& turn, const Control& control) {
  const std::optional<ColumnsAndRows> places = columns_and_rows(turn, source.width);
  if (!places) return {};
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(source.width);
  LatLongImage result{source.width, source.height,
                      std::vector<float>(row_floats * static_cast<std::size_t>(source.height))};
  for_each_row(source.height, source.width, control, [&](int row) {
    float* rgb = result.pixels.data() + static_cast<std::size_t>(row) * row_floats;
    const auto* from =
        static_cast<const std::byte*>(row_of(source, places->rows_reversed ? source.height - 1 - row : row));
    const std::size_t texel_bytes = bytes_per_texel(source.format);
    for (int column = 0; column < source.width; ++column, rgb += 3) {
      const auto at = static_cast<std::size_t>(places->source_column(column, source.width));
      decode_texels(source.format, from + at * texel_bytes, 1, rgb);
    }
  });
  return result;
}

}  // namespace welkin::image
