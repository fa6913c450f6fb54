#include "reflections/cube_rings.h"

#include <algorithm>
#include <cstddef>

#include "reflections/ring_table.h"

namespace welkin::reflections {

Rings rings_of_cubemap(const std::vector<const float*>& faces, int rows, const Control& control) {
  const std::size_t floats = std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows);
  Rings rings{{}, platform::AlignedBuffer<float>(floats)};
  rings.view = transforms::PictureRows(LatLongView{rings.owned.data(), 2 * rows, rows});
  const auto table = RingTable::get({static_cast<int>(faces.size() / 6), rows}, {control.stop});
  table->fill(faces, rings.owned.data(), control);
  return rings;
}

SourceRows rows_without(const std::vector<BrightTexel>& bright, const projection::SanitizedSource& source) {
  std::size_t changed = 0;
  for (std::size_t k = 0; k < bright.size(); ++k) changed += k == 0 || bright[k].row != bright[k - 1].row ? 1 : 0;
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.columns());
  SourceRows rest{{}, platform::AlignedBuffer<float>(changed * row_values)};
  for (int row = 0; row < source.rows(); ++row) rest.rows.push_back(source.row(row));
  float* next = rest.owned.data();
  float* copy = nullptr;
  int row = -1;
  for (const BrightTexel& texel : bright) {  // by rows
    if (texel.row != row) {
      row = texel.row;
      copy = next;
      next = std::copy_n(source.row(row), row_values, copy);
      rest.rows[static_cast<std::size_t>(row)] = copy;
    }
    std::copy(texel.rest.begin(), texel.rest.end(), copy + std::ptrdiff_t{3} * texel.column);
  }
  return rest;
}

Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright, int rows,
               const Control& control) {
  SourceRows rest = rows_without(bright, source);
  if (source.cubemap()) return rings_of_cubemap(rest.rows, rows, control);
  Rings rings{transforms::PictureRows(source.lat_long()), std::move(rest.owned)};
  rings.view.rows = std::move(rest.rows);
  return rings;
}

std::size_t cube_rings_bytes(int size, int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  return halved_faces_bytes(size, face_size) + RingTable::working_bytes(key) + RingTable::making_bytes(key);
}

}  // namespace welkin::reflections
