#include "reflections/cube_rings.h"

#include <algorithm>
#include <cstddef>

#include "image/pixels.h"
#include "reflections/halved_faces.h"
#include "reflections/ring_table.h"

namespace welkin::reflections {

Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  const std::size_t floats = std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows);
  Rings rings{{}, platform::AlignedBuffer<float>(floats)};
  rings.view = transforms::PictureRows(LatLongView{rings.owned.data(), 2 * rows, rows});
  RingTable::get({source.size, rows}, {control.stop})->fill(source, rings.owned.data(), control);
  return rings;
}

namespace {

/// A picture's rows, those with bright texels copied, and no others: a panorama may have hundreds of megabytes.
struct RowsWithout {
  std::vector<const float*> rows;
  platform::AlignedBuffer<float> owned;
};

RowsWithout rows_without(const std::vector<BrightTexel>& bright, const projection::SanitizedSource& source) {
  std::size_t changed = 0;
  for (std::size_t k = 0; k < bright.size(); ++k) changed += k == 0 || bright[k].row != bright[k - 1].row ? 1 : 0;
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.columns());
  RowsWithout rest{{}, platform::AlignedBuffer<float>(changed * row_values)};
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

bool follow_each_other(const projection::SanitizedSource& source) {
  const float* next = source.row(0);
  for (int row = 0; row < source.rows(); ++row, next += std::ptrdiff_t{3} * source.columns()) {
    if (source.row(row) != next) return false;
  }
  return true;
}

}  // namespace

CubemapView PackedFaces::view() const { return image::packed_cubemap(rgb, size); }

std::vector<const float*> PackedFaces::rows() const {
  std::vector<const float*> rows;
  rows.reserve(static_cast<std::size_t>(6 * size));
  for (int row = 0; row < 6 * size; ++row) rows.push_back(rgb + std::ptrdiff_t{3} * size * row);
  return rows;
}

PackedFaces faces_without(const std::vector<BrightTexel>& bright, const projection::SanitizedSource& source, int size,
                          const Control& control) {
  PackedFaces faces{size};
  if (size != source.columns()) {
    const RowsWithout rest = rows_without(bright, source);
    faces.owned = halved_faces(rest.rows, size, {control.stop, {}});
  } else if (!bright.empty() || !follow_each_other(source)) {
    faces.owned = pixels_without(bright, source);
  } else {
    faces.rgb = source.row(0);
  }
  if (faces.rgb == nullptr) faces.rgb = faces.owned.data();
  return faces;
}

PackedFaces halved(const PackedFaces& faces, int size, const Control& control) {
  if (size == faces.size) return {size, faces.rgb};
  PackedFaces result{size};
  result.owned = halved_faces(faces.rows(), size, {control.stop, {}});
  result.rgb = result.owned.data();
  return result;
}

Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright, int rows,
               const Control& control) {
  if (source.cubemap())
    return rings_of_cubemap(faces_without(bright, source, source.columns(), control).view(), rows, control);
  RowsWithout rest = rows_without(bright, source);
  Rings rings{transforms::PictureRows(source.lat_long()), std::move(rest.owned)};
  rings.view.rows = std::move(rest.rows);
  return rings;
}

std::size_t cube_rings_bytes(int size, int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  return halved_faces_bytes(size, face_size) + RingTable::working_bytes(key) + RingTable::making_bytes(key);
}

}  // namespace welkin::reflections
