#include "reflections/cube_rings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "image/area_resampling.h"
#include "image/pixels.h"
#include "reflections/ring_table.h"

namespace welkin::reflections {
namespace {

constexpr double kShare = 1.0 / 12.0;  ///< the mean of x (1 - x) / 2
constexpr double kOnEdge = 1e-9;       ///< columns: rounding

}  // namespace

RingSharpener::RingSharpener(int rows, int face_size)
    : rows_(rows), even_(face_size % 2 == 0), columns_(static_cast<std::size_t>(2 * rows)) {
  for (int side = 0; side < 4; ++side) {
    for (int edge = 0; edge < face_size; ++edge) {
      const double place = (2.0 * edge - face_size) / face_size;  // on the face, -1 to 1
      const double turns = 0.25 * side + math::turns_of(place, 1.0);
      // The meridian leaves the face at tan(latitude) = cos(longitude); one through its middle goes on to the pole.
      const double reach =
          2 * edge == face_size ? std::numeric_limits<double>::infinity() : 1.0 / std::sqrt(1.0 + place * place);
      add_meridian(turns, reach);
    }
  }
}

void RingSharpener::add_meridian(double turns, double reach) {
  const auto count = static_cast<double>(columns_.size());
  const double column = (turns - std::floor(turns)) * count;
  const double whole = std::floor(column + kOnEdge);
  const double part = std::max(0.0, column - whole);
  const auto flow = static_cast<float>(0.5 * part * (1.0 - part) / kShare);
  const std::size_t first = static_cast<std::size_t>(whole) % columns_.size();
  columns_[first] = {flow, reach};
  if (part > kOnEdge) columns_[(first + 1) % columns_.size()] = {flow, reach};
}

math::SineCosine RingSharpener::edge_of(int row) const { return math::sine_cosine_of_turns(row / (2.0 * rows_)); }

double RingSharpener::mean_sine(int row) const {
  return (edge_of(row).cosine - edge_of(row + 1).cosine) * rows_ / std::numbers::pi;
}

double RingSharpener::steepness(int row) const {
  const math::SineCosine middle = math::sine_cosine_of_turns((row + 0.5) / (2.0 * rows_));
  return std::abs(middle.cosine) / middle.sine;
}

double RingSharpener::flow_above(int row) const {
  const bool pole = row == 0 || row == rows_;
  return pole || (even_ && 2 * row == rows_) ? 0.0 : edge_of(row).sine;
}

float RingSharpener::flow_before(int column, double steepness) const {
  const ColumnEdge& edge = columns_[static_cast<std::size_t>(column)];
  return steepness < edge.reach ? edge.flow : 1.0F;
}

void RingSharpener::sharpen(float* rings) const {
  const auto width = static_cast<int>(columns_.size());
  const auto values = std::size_t{3} * static_cast<std::size_t>(width);
  std::vector<float> flows(static_cast<std::size_t>(width));
  std::vector<float> above(values);
  std::vector<float> here(values);
  for (int row = 0; row < rows_; ++row) {
    float* const out = rings + values * static_cast<std::size_t>(row);
    const float* const below = row + 1 == rows_ ? out : out + values;
    // Along the column differences flow by the edge's sine over the row's mean: no light is lost.
    const double sine = mean_sine(row);
    const auto up = static_cast<float>(flow_above(row) / sine);
    const auto down = static_cast<float>(flow_above(row + 1) / sine);
    const double steep = steepness(row);
    for (int column = 0; column < width; ++column) flows[static_cast<std::size_t>(column)] = flow_before(column, steep);
    std::copy_n(out, values, here.data());
    for (int column = 0; column < width; ++column) {
      const int left = column > 0 ? column - 1 : width - 1;
      const int right = column + 1 < width ? column + 1 : 0;
      const float before = flows[static_cast<std::size_t>(column)];
      const float after = flows[static_cast<std::size_t>(right)];
      for (int c = 0; c < 3; ++c) {
        const auto k = static_cast<std::size_t>(3 * column + c);
        const float own = here[k];
        const float along = before * (here[static_cast<std::size_t>(3 * left + c)] - own) +
                            after * (here[static_cast<std::size_t>(3 * right + c)] - own);
        const float across = up * (above[k] - own) + down * (below[k] - own);
        out[k] = own - (along + across) * static_cast<float>(kShare);
      }
    }
    above.swap(here);
  }
}

namespace {

/// Each texel `parts` x `parts` times, packed.
platform::AlignedBuffer<float> cut(const CubemapView& source, int parts) {
  const auto row_values = std::ptrdiff_t{3} * source.size;
  const auto cut_values = row_values * parts;
  platform::AlignedBuffer<float> result(static_cast<std::size_t>(6 * cut_values) *
                                        static_cast<std::size_t>(source.size * parts));
  float* to = result.data();
  for (int row = 0; row < 6 * source.size; ++row) {
    const auto* const from = static_cast<const float*>(image::row_of(source, row / source.size, row % source.size));
    float* const first = to;
    for (int column = 0; column < source.size; ++column) {
      for (int part = 0; part < parts; ++part, to += 3) std::copy_n(from + std::ptrdiff_t{3} * column, 3, to);
    }
    for (int part = 1; part < parts; ++part, to += cut_values) std::copy_n(first, cut_values, to);
  }
  return result;
}

}  // namespace

namespace {

/// 2 rows x rows texels that are not filled yet.
Rings room_for(int rows) {
  Rings rings{
      {},
      platform::AlignedBuffer<float>(std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows))};
  rings.view = {rings.owned.data(), 2 * rows, rows, 0, PixelFormat::rgb32f};
  return rings;
}

}  // namespace

Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  Rings rings = room_for(rows);
  const int parts = std::max(1, rows / (2 * source.size));
  if (parts == 1) {
    image::fill_lat_long_by_area(source, 2 * rows, rows, rings.owned.data(), control);
  } else {
    const platform::AlignedBuffer<float> texels = cut(source, parts);
    image::fill_lat_long_by_area(image::packed_cubemap(texels.data(), source.size * parts), 2 * rows, rows,
                                 rings.owned.data(), control);
  }
  return rings;
}

Rings sharp_rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  const RingTableKey key{source.size, rows};
  if (RingTable::serves(key)) {
    Rings rings = room_for(rows);
    RingTable::get(key, {control.stop})->fill(source, rings.owned.data(), control);
    return rings;
  }
  Rings rings = rings_of_cubemap(source, rows, control);
  RingSharpener(rows, source.size).sharpen(rings.owned.data());
  return rings;
}

Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright, int rows,
               const Control& control) {
  if (!source.cubemap() && bright.empty()) return {source.lat_long(), {}};
  if (bright.empty()) return sharp_rings_of_cubemap(source.cube(), rows, control);
  platform::AlignedBuffer<float> rest = pixels_without(bright, source);
  if (source.cubemap())
    return sharp_rings_of_cubemap(image::packed_cubemap(rest.data(), source.columns()), rows, control);
  const LatLongView view{rest.data(), source.columns(), source.rows(), 0, PixelFormat::rgb32f};
  return {view, std::move(rest)};
}

std::size_t cube_rings_bytes(int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  if (RingTable::serves(key)) return RingTable::working_bytes(key) + RingTable::making_bytes(key);
  constexpr std::size_t texel = 24 + 9;  // of the area resampler and the sharpener
  return texel * 2 * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows);
}

}  // namespace welkin::reflections
