#include "importance/row_weights.h"

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <string>

#include "image/pixels.h"
#include "math/elementary.h"

namespace welkin::importance {
namespace {

double weight_of(const float* rgb, ImportanceWeight weight) noexcept {
  const double red = rgb[0];
  const double green = rgb[1];
  const double blue = rgb[2];
  switch (weight) {
    case ImportanceWeight::mean: return std::max(0.0, (red + green + blue) / 3.0);
    case ImportanceWeight::largest: return std::max({0.0, red, green, blue});
    default: return std::max(0.0, 0.2126 * red + 0.7152 * green + 0.0722 * blue);
  }
}

}  // namespace

RowWeights::RowWeights(const LatLongView& source, ImportanceWeight weight, const PixelPolicy& pixels)
    : source_(source), weight_(weight), sanitizer_(pixels) {}

void RowWeights::read(int row, Scratch& scratch, std::span<double> weights) const {
  const int columns = source_.width;
  const void* const texels = image::row_of(source_, row);
  const float* rgb = scratch.rgb.data();
  const bool as_they_are = source_.format == PixelFormat::rgb32f &&
                           !sanitizer_.may_change(source_.format, static_cast<const float*>(texels), columns);
  if (as_they_are) {
    rgb = static_cast<const float*>(texels);
  } else {
    image::decode_texels(source_.format, texels, columns, scratch.rgb.data());
    if (sanitizer_.may_change(source_.format, rgb, columns)) {
      static constexpr float kUnused = 0.0F;  // what a clamp takes away is of no interest here
      sanitizer_.sanitize({.rgb = scratch.rgb.data(),
                           .count = columns,
                           .face = 0,
                           .row = row,
                           .first_column = 0,
                           .weights = &kUnused,
                           .weight_step = 0,
                           .weight_scale = 1.0},
                          scratch.record);
    }
  }
  for (std::size_t k = 0; k < weights.size(); ++k) {
    // A policy may let NaN and infinities pass; a distribution cannot hold them.
    const double weight = weight_of(rgb + 3 * k, weight_);
    weights[k] = weight <= 3.0 * 3.402823466e38 ? weight : 0.0;
  }
}

// With both edges in units of 1 / (texels cells) of the circle, everything is a whole number.
Overlaps Overlaps::of_columns(int texels, int cells) {
  Overlaps result;
  for (std::int64_t cell = 0; cell < cells; ++cell) {
    const std::int64_t from = cell * texels;
    const std::int64_t to = from + texels;
    for (std::int64_t texel = from / cells; texel * cells < to; ++texel) {
      const std::int64_t overlap = std::min(to, (texel + 1) * cells) - std::max(from, texel * cells);
      result.shares_.push_back({static_cast<int>(texel), static_cast<double>(overlap) / cells});
    }
    result.first_.push_back(result.shares_.size());
  }
  return result;
}

Overlaps Overlaps::of_rows(int texels, int cells) {
  Overlaps result;
  for (std::int64_t cell = 0; cell < cells; ++cell) {
    const std::int64_t from = cell * texels;
    const std::int64_t to = from + texels;
    for (std::int64_t texel = from / cells; texel * cells < to; ++texel) {
      // The edge that bounds the overlap is the cell's or the texel's.
      const double top = texel * cells >= from ? height_of_edge(static_cast<int>(texel), texels)
                                               : height_of_edge(static_cast<int>(cell), cells);
      const double bottom = (texel + 1) * cells <= to ? height_of_edge(static_cast<int>(texel) + 1, texels)
                                                      : height_of_edge(static_cast<int>(cell) + 1, cells);
      result.shares_.push_back({static_cast<int>(texel), bottom - top});
    }
    result.first_.push_back(result.shares_.size());
  }
  return result;
}

double height_of_edge(int row, int rows) noexcept {
  if (row == 0 || row == rows) return row == 0 ? -1.0 : 1.0;
  return -math::sine_cosine_of_turns(0.5 * row / rows).cosine;
}

double texel_solid_angle(int width, int height, int row) noexcept {
  return (height_of_edge(row + 1, height) - height_of_edge(row, height)) * 2.0 * std::numbers::pi / width;
}

void check_table(const ImportanceTable& table) {
  const auto width = static_cast<std::size_t>(std::max(table.width, 0));
  const auto height = static_cast<std::size_t>(std::max(table.height, 0));
  if (width > 0 && height > 0 && table.function.size() == width * height && table.row_cdf.size() == height + 1 &&
      table.column_cdf.size() == height * (width + 1)) {
    return;
  }
  throw Error(ErrorCode::invalid_argument,
              "the importance table of " + std::to_string(table.width) + " x " + std::to_string(table.height) +
                  " texels has arrays of other lengths; pass one that importance_table has made");
}

}  // namespace welkin::importance
