// Turns of images that need no samples between texels: those that take texels to texels, or rows to rows.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "image/resampling.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {
namespace {

// A row of a lat-long that is moved along itself by a fraction of a texel.

struct Range {
  double minimum;
  double maximum;
};

/// The range of the four texels around a position; `texel` is the one before it.
Range range_at(const double* texel) noexcept {
  return {std::min(std::min(texel[-1], texel[0]), std::min(texel[1], texel[2])),
          std::max(std::max(texel[-1], texel[0]), std::max(texel[1], texel[2]))};
}

/// One channel of a row. Linear interpolation keeps the row's sum and every range, but blurs. Cubic convolution
/// (Catmull-Rom) adds a flux between neighbours, p (a - b) + q (b - c) from texel b to a, which keeps the sum as well.
/// Each flux is limited so that every result stays between the minimum and the maximum of the four texels around its
/// position (S. T. Zalesak, "Fully multidimensional flux-corrected transport algorithms for fluids", 1979). Where a
/// texel is NaN or infinite the interpolation remains linear.
class MovedRow {
 public:
  /// Result i lies `share` of a texel, from 0 to 1, after texel i.
  MovedRow(int width, double share)
      : width_(width), share_(share), texels_(static_cast<std::size_t>(width + 2 * kBorder + 1)) {
    for (std::vector<double>* const values : {&linear_, &flux_, &rise_, &fall_}) {
      values->resize(static_cast<std::size_t>(width + kBorder + 1));
    }
  }

  double& texel(int column) noexcept { return texels_[static_cast<std::size_t>(column + kBorder)]; }

  /// Writes the results, `step` floats apart, once all texels are set.
  void write(float* results, int step) noexcept {
    wrap();
    interpolate();
    limit();
    for (int i = 0; i < width_; ++i) {
      const auto at = static_cast<std::size_t>(i + kBorder);
      const Range range = range_at(texels_.data() + at);
      const double value = linear_[at] + (flux_[at] - flux_[at - 1]);
      results[std::ptrdiff_t{i} * step] = static_cast<float>(std::min(std::max(value, range.minimum), range.maximum));
    }
  }

 private:
  static constexpr int kBorder = 2;  ///< texels before the first one; as many and one more follow the last

  void wrap() noexcept {
    for (int i = 0; i < kBorder; ++i) texel(i - kBorder) = texel((width_ * kBorder + i - kBorder) % width_);
    for (int i = 0; i <= kBorder; ++i) texel(width_ + i) = texel(i % width_);
  }

  void interpolate() noexcept {
    const double p = 0.5 * share_ * (1.0 - share_) * (1.0 - share_);
    const double q = 0.5 * share_ * share_ * (1.0 - share_);
    for (int i = 0; i < width_ + kBorder + 1; ++i) {
      const double* const texel = texels_.data() + i;
      const double flux = p * (texel[0] - texel[1]) + q * (texel[1] - texel[2]);
      const auto at = static_cast<std::size_t>(i);
      linear_[at] = (1.0 - share_) * texel[0] + share_ * texel[1];
      flux_[at] = std::abs(flux) <= std::numeric_limits<double>::max() ? flux : 0.0;
    }
  }

  void limit() noexcept {
    for (int i = 1; i < width_ + kBorder + 1; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Range range = range_at(texels_.data() + i);
      const double in = std::max(flux_[at], 0.0) + std::max(-flux_[at - 1], 0.0);
      const double out = std::max(-flux_[at], 0.0) + std::max(flux_[at - 1], 0.0);
      rise_[at] = in > 0.0 ? std::min(1.0, (range.maximum - linear_[at]) / in) : 0.0;
      fall_[at] = out > 0.0 ? std::min(1.0, (linear_[at] - range.minimum) / out) : 0.0;
    }
    for (int i = 1; i < width_ + kBorder; ++i) {
      const auto at = static_cast<std::size_t>(i);
      flux_[at] *= flux_[at] > 0.0 ? std::min(rise_[at], fall_[at + 1]) : std::min(fall_[at], rise_[at + 1]);
    }
  }

  int width_;
  double share_;
  std::vector<double> texels_;
  // Texel i is at i + kBorder, from -kBorder to the width.
  std::vector<double> linear_;
  std::vector<double> flux_;  ///< into each texel from the next one
  std::vector<double> rise_;  ///< the shares of what flows in
  std::vector<double> fall_;  ///< and out that keep the result within its range
};

constexpr double kMatrixTolerance = 1e-9;
constexpr double kColumnTolerance = 1e-6;
constexpr int kTileTexels = 16384;

bool is_near(double value, double wanted) { return std::abs(value - wanted) <= kMatrixTolerance; }

/// Where a lat-long's columns and rows come from.
struct ColumnsAndRows {
  bool rows_reversed = false;
  bool columns_reversed = false;
  int shift = 0;       // column i of the source becomes i - shift, or width - 1 - i - shift; from 0 to width - 1
  double share = 0.0;  // and by so much of a column more, below 1

  [[nodiscard]] int source_column(int column, int width) const {
    const int moved = (column + shift) % width;
    return columns_reversed ? (width - 1 - moved) : moved;
  }
};

/// A longitude, in turns, becomes shift + itself, or shift - itself if the image is mirrored: the columns move left
/// by shift times the width.
std::optional<ColumnsAndRows> columns_and_rows(const glm::dmat3& rotation, int width) {
  const glm::dvec3 up = rotation * glm::dvec3(0, 1, 0);
  if (!is_near(std::abs(up.y), 1.0) || !is_near(up.x, 0.0) || !is_near(up.z, 0.0)) return {};
  const glm::dvec3 ahead = rotation * glm::dvec3(0, 0, 1);
  const glm::dvec3 left = rotation * glm::dvec3(1, 0, 0);
  // `ahead` and `left` have the longitudes 0 and 1/4 turn. The longitude of the rotated `ahead` is the shift, and
  // whether `left` is still to the left of it (their cross product's sign) says whether the order of longitudes stays.
  const double shift = math::turns_of(ahead.x, ahead.z) * width;
  const bool is_whole = std::abs(shift - std::round(shift)) <= kColumnTolerance;
  const double whole = is_whole ? std::round(shift) : std::floor(shift);
  const int wrapped = (static_cast<int>(whole) % width + width) % width;
  return ColumnsAndRows{up.y < 0.0, ahead.z * left.x - ahead.x * left.z < 0.0, wrapped, is_whole ? 0.0 : shift - whole};
}

/// Calls `move(row)` for each of `rows` rows, several at a time.
template <typename Move>
void for_each_row(int rows, int width, const Control& control, const Move& move) {
  const int tile_rows = std::max(1, kTileTexels / width);
  const jobs::Placement where = jobs::placement_for(static_cast<std::int64_t>(rows) * width);
  jobs::run_rows(rows, tile_rows, where, jobs::worker_count(where), control, [&](int row, std::size_t) { move(row); });
}

}  // namespace

std::optional<Cubemap> rotate_exactly(const CubemapView& source, const glm::dmat3& rotation, const Control& control) {
  const std::optional<WholeMatrix> forward = cube_symmetry_of(rotation);
  if (!forward) return {};
  const int size = source.size;
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(size);
  Cubemap result(size, 1, control.memory);
  for_each_row(6 * size, size, control, [&](int strip_row) {
    float* rgb = result.face(0) + static_cast<std::size_t>(strip_row) * row_floats;
    const std::size_t texel_bytes = bytes_per_texel(source.format);
    for (int column = 0; column < size; ++column, rgb += 3) {
      const glm::ivec3 point = point_of(size, {strip_row / size, column, strip_row % size});
      const CubeTexel from = texel_at(size, point * *forward);  // the inverse: the transpose from the left
      const auto* row = static_cast<const std::byte*>(row_of(source, from.face, from.row));
      decode_texels(source.format, row + static_cast<std::size_t>(from.column) * texel_bytes, 1, rgb);
    }
  });
  return result;
}

namespace {

void copy_columns(const LatLongView& source, int row, const ColumnsAndRows& mapping, float* rgb) {
  const auto* const from = static_cast<const std::byte*>(row_of(source, row));
  const std::size_t texel_bytes = bytes_per_texel(source.format);
  for (int column = 0; column < source.width; ++column, rgb += 3) {
    const auto at = static_cast<std::size_t>(mapping.source_column(column, source.width));
    decode_texels(source.format, from + at * texel_bytes, 1, rgb);
  }
}

void move_columns(const FloatPlane& source, int width, int row, const ColumnsAndRows& mapping, float* rgb) {
  MovedRow moved(width, mapping.share);
  for (int channel = 0; channel < 3; ++channel) {
    for (int column = 0; column < width; ++column) {
      moved.texel(column) = static_cast<double>(source.texel(mapping.source_column(column, width), row)[channel]);
    }
    moved.write(rgb + channel, 3);
  }
}

}  // namespace

std::optional<LatLongImage> moved_along_rows(const LatLongView& source, const glm::dmat3& rotation,
                                             const Control& control) {
  const std::optional<ColumnsAndRows> mapping = columns_and_rows(rotation, source.width);
  if (!mapping) return {};
  std::optional<FloatPlane> plane;
  if (mapping->share > 0.0) plane.emplace(source);
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(source.width);
  LatLongImage result{source.width, source.height,
                      std::vector<float>(row_floats * static_cast<std::size_t>(source.height))};
  for_each_row(source.height, source.width, control, [&](int row) {
    const int from = mapping->rows_reversed ? source.height - 1 - row : row;
    float* const rgb = result.pixels.data() + static_cast<std::size_t>(row) * row_floats;
    plane ? move_columns(*plane, source.width, from, *mapping, rgb) : copy_columns(source, from, *mapping, rgb);
  });
  return result;
}

}  // namespace welkin::image
