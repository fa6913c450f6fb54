#include "reflections/texel_images.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numbers>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMargin = 2;  ///< columns and rows that groups of directions may look at beyond the circle

int texels(double count) { return static_cast<int>(std::ceil(count)) + kMargin; }

/// Columns to either side of a direction that a circle about it reaches in a row of a lat-long, wherever it is.
int most_columns(int columns, int rows, int row, double reach) {
  // the end of the row that is nearer to a pole
  const double end =
      0.5 * std::max(std::abs(0.5 - static_cast<double>(row) / rows), std::abs(0.5 - (row + 1.0) / rows));
  const double cosine = math::sine_cosine_of_turns(end).cosine;
  const double sine = math::sine_cosine_of_turns(reach / (2.0 * kPi)).sine;
  if (sine >= 0.99 * cosine) return columns / 2;
  return std::min(columns / 2, texels(math::arc_sine(sine / cosine) * columns / (2.0 * kPi)));
}

}  // namespace

std::vector<TexelImages::Patch> TexelImages::patches_for(bool cubemap, int columns, int rows, double reach) {
  std::vector<Patch> patches;
  const auto add_row = [&](int first, int end) { patches.back().rows.push_back({{first, end}, nullptr}); };
  if (!cubemap) {
    patches.push_back({0, {}});
    const int end = std::min(rows, (rows + 1) / 2 + texels(reach * rows / kPi));
    for (int row = 0; row < end; ++row) {
      const int side = most_columns(columns, rows, row, reach);
      add_row(3 * columns / 8 - side, (columns + 1) / 2 + side);
    }
    return patches;
  }
  const int size = columns;
  const double wide = 0.5 * size * reach * (1.0 + reach);
  const int middle = std::max(0, size / 2 - texels(1.5 * wide));  // a direction moves by 1.4 at most as an angle of one
  const int below = size - middle;
  const int beyond = std::min(size, texels(2.6 * wide));  // beside a corner by 2.4
  patches.push_back({0, {}});
  for (int row = 0; row < below; ++row) add_row(middle, size);
  patches.push_back({0, {}});
  for (int row = 0; row < below; ++row) add_row(0, beyond);
  patches.push_back({middle, {}});
  for (int row = middle; row < size; ++row) add_row(middle, std::min(size, std::max(row, middle) + 2 * beyond));
  return patches;
}

std::size_t TexelImages::bytes_for(bool cubemap, int columns, int rows, double reach) noexcept {
  std::size_t floats = 0;
  for (const Patch& patch : patches_for(cubemap, columns, rows, reach)) {
    for (const Row& row : patch.rows)
      floats += static_cast<std::size_t>(row.columns.end - row.columns.first) * kImageFloats;
  }
  return floats * sizeof(float);
}

TexelImages::TexelImages(const projection::SanitizedSource& source, const TexelParts& parts, double reach,
                         const Control& control)
    : cubemap_(source.cubemap()),
      columns_(source.columns() * parts.columns),
      rows_((source.cubemap() ? source.columns() : source.rows()) * parts.rows),
      patches_(patches_for(cubemap_, columns_, rows_, reach)),
      floats_(bytes_for(cubemap_, columns_, rows_, reach) / sizeof(float)) {
  struct Place {
    int patch;
    int row;
  };
  std::vector<Place> places;
  float* next = floats_.data();
  for (int patch = 0; patch < patches(); ++patch) {
    Patch& own = patches_[static_cast<std::size_t>(patch)];
    for (std::size_t row = 0; row < own.rows.size(); ++row) {
      places.push_back({patch, own.first_row + static_cast<int>(row)});
      own.rows[row].texels = next;
      next += static_cast<std::ptrdiff_t>(own.rows[row].columns.end - own.rows[row].columns.first) * kImageFloats;
    }
  }
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(floats_.size() / 4));
  jobs::run_tiles(
      places.size(), placement, jobs::worker_count(placement), control,
      [&](std::size_t tile, std::size_t /*worker*/) { fill(source, parts, places[tile].patch, places[tile].row); });
}

// NOLINTNEXTLINE(readability-make-member-function-const): the texels that it writes are this object's
void TexelImages::fill(const projection::SanitizedSource& source, const TexelParts& parts, int patch, int row) {
  const ColumnRange range = this->row(patch, row).columns;
  for (int index = 0; index < kImages; ++index) {
    const image::CubeImage image = image::cube_image_of(index);
    float* to = this->row(patch, row).texels + 3 * index;
    const auto copy = [&](const float* rgb) {
      for (int c = 0; c < 3; ++c) to[c] = rgb[c];  // a call of a function otherwise
      to += kImageFloats;
    };
    if (cubemap_) {
      const int face = faces()[static_cast<std::size_t>(patch)];
      const auto moved = [&](int column) {
        return image::texel_at(columns_, image::moved(image, image::point_of(columns_, {face, column, row})));
      };
      const image::CubeTexel from = moved(range.first);
      const image::CubeTexel next = moved(range.first + (columns_ > 1 && range.first + 1 < columns_ ? 1 : 0));
      for (int k = 0; k < range.end - range.first; ++k) {
        const int column = from.column + k * (next.column - from.column);
        const int of = from.row + k * (next.row - from.row);
        copy(source.row(from.face * source.columns() + of / parts.rows) + std::ptrdiff_t{3} * (column / parts.columns));
      }
      continue;
    }
    const float* const pixels = source.row((image.below ? rows_ - 1 - row : row) / parts.rows);
    const int step = image.mirrored ? -1 : 1;
    int column = (image.mirrored ? columns_ - 1 - range.first : range.first) + image.quarter * (columns_ / 4);
    column = ((column % columns_) + columns_) % columns_;
    for (int k = range.first; k < range.end; ++k) {
      copy(pixels + std::ptrdiff_t{3} * (column / parts.columns));
      column += step;
      if (column == columns_) column = 0;
      if (column < 0) column = columns_ - 1;
    }
  }
}

}  // namespace welkin::reflections
