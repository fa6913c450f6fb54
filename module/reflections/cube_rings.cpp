#include "reflections/cube_rings.h"

#include <algorithm>
#include <cstddef>

#include "image/pixels.h"
#include "reflections/ring_table.h"
#include "welkin/resampling.h"

namespace welkin::reflections {

Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  const std::size_t floats = std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows);
  Rings rings{{}, platform::AlignedBuffer<float>(floats)};
  rings.view = transforms::PictureRows(LatLongView{rings.owned.data(), 2 * rows, rows});
  RingTable::get({source.size, rows}, {control.stop})->fill(source, rings.owned.data(), control);
  return rings;
}

namespace {

/// Copies the rows that have bright texels, and no others: a panorama may have hundreds of megabytes.
Rings lat_long_without(const std::vector<BrightTexel>& bright, const projection::SanitizedSource& source) {
  std::size_t changed = 0;
  for (std::size_t k = 0; k < bright.size(); ++k) changed += k == 0 || bright[k].row != bright[k - 1].row ? 1 : 0;
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.columns());
  Rings rings{transforms::PictureRows(source.lat_long()), platform::AlignedBuffer<float>(changed * row_values)};
  float* next = rings.owned.data();
  float* copy = nullptr;
  int row = -1;
  for (const BrightTexel& texel : bright) {  // by rows
    if (texel.row != row) {
      row = texel.row;
      copy = next;
      next = std::copy_n(source.row(row), row_values, copy);
      rings.view.rows[static_cast<std::size_t>(row)] = copy;
    }
    std::copy(texel.rest.begin(), texel.rest.end(), copy + std::ptrdiff_t{3} * texel.column);
  }
  return rings;
}

}  // namespace

Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright, int rows,
               const Control& control, int face_size) {
  if (!source.cubemap()) return lat_long_without(bright, source);
  platform::AlignedBuffer<float> rest;
  if (!bright.empty()) rest = pixels_without(bright, source);
  const CubemapView whole = bright.empty() ? source.cube() : image::packed_cubemap(rest.data(), source.columns());
  if (face_size == 0 || face_size == source.columns()) return rings_of_cubemap(whole, rows, control);
  const CubemapImage smaller = to_cubemap(whole, face_size, glm::dmat3(1.0), {control.stop, {}});
  return rings_of_cubemap(smaller.view(), rows, control);
}

std::size_t cube_rings_bytes(int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  return RingTable::working_bytes(key) + RingTable::making_bytes(key);
}

}  // namespace welkin::reflections
