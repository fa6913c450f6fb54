#include "importance/row_weights.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include "image/pixels.h"
#include "math/elementary.h"

namespace welkin::importance {
namespace {

/// A policy may let NaN and infinities pass; a distribution cannot hold them.
template <class Weight>
void weigh(const float* rgb, std::span<float> weights, const Weight& weight) noexcept {
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const float value = weight(rgb[3 * k], rgb[3 * k + 1], rgb[3 * k + 2]);
    weights[k] = value > 0.0F && value <= std::numeric_limits<float>::max() ? value : 0.0F;
  }
}

}  // namespace

RowWeights::RowWeights(const LatLongView& source, ImportanceWeight weight, const PixelPolicy& pixels)
    : source_(source), weight_(weight), sanitizer_(pixels) {}

std::span<const float> RowWeights::read(int row, Scratch& scratch) const {
  std::vector<float>& weights = scratch.weights;
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
      sanitizer_.sanitize({.rgb = scratch.rgb.data(), .count = columns, .row = row}, scratch.record);
    }
  }
  switch (weight_) {
    case ImportanceWeight::mean:
      // Thirds first: the sum of three large floats could be infinite.
      weigh(rgb, weights, [](float r, float g, float b) { return r / 3.0F + g / 3.0F + b / 3.0F; });
      break;
    case ImportanceWeight::largest:
      weigh(rgb, weights, [](float r, float g, float b) { return std::max(std::max(r, g), b); });
      break;
    default: weigh(rgb, weights, [](float r, float g, float b) { return 0.2126F * r + 0.7152F * g + 0.0722F * b; });
  }
  return weights;
}

// With all edges in units of 1 / (texels cells) of the axis, they are whole numbers.
template <class Part>
Overlaps Overlaps::of(int texels, int cells, const Part& part) {
  Overlaps result;
  for (std::int64_t cell = 0; cell < cells; ++cell) {
    const std::int64_t from = cell * texels;
    const std::int64_t to = from + texels;
    for (std::int64_t texel = from / cells; texel * cells < to; ++texel) {
      const Edge begin{std::max(from, texel * cells), from > texel * cells, cell, texel};
      const Edge end{std::min(to, (texel + 1) * cells), to < (texel + 1) * cells, cell + 1, texel + 1};
      result.shares_.push_back({static_cast<int>(texel), part(begin, end)});
    }
    result.first_.push_back(result.shares_.size());
  }
  return result;
}

Overlaps Overlaps::of_columns(int texels, int cells) {
  return of(texels, cells,
            [&](const Edge& begin, const Edge& end) { return static_cast<double>(end.place - begin.place) / cells; });
}

Overlaps Overlaps::of_rows(int texels, int cells) {
  // 0.5 row / rows in height_of_edge is rounded once, so an edge that a cell and a texel share has one height,
  // whichever counts it: heights of a cell's parts add up without gap or overlap.
  const auto height = [&](const Edge& edge) {
    return edge.of_cell ? height_of_edge(static_cast<int>(edge.cell), cells)
                        : height_of_edge(static_cast<int>(edge.texel), texels);
  };
  return of(texels, cells, [&](const Edge& begin, const Edge& end) { return height(end) - height(begin); });
}

double height_of_edge(int row, int rows) noexcept {
  if (row == 0 || row == rows) return row == 0 ? -1.0 : 1.0;
  return -math::sine_cosine_of_turns(0.5 * row / rows).cosine;
}

double texel_solid_angle(int width, int height, int row) noexcept {
  // Archimedes: a zone's solid angle is 2 pi times its height. These are differences of edges' heights, not the product
  // of image/geometry.cpp: with the same edges the parts of a texel in several cells add up to the texel.
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
