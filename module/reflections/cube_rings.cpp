#include "reflections/cube_rings.h"

#include <cstddef>

#include "reflections/ring_table.h"

namespace welkin::reflections {

LatLongImage rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  LatLongImage rings{2 * rows, rows, {}};
  rings.pixels.resize(std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows));
  RingTable::get({source.size, rows}, {control.stop})->fill(source, rings.pixels.data(), control);
  return rings;
}

Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright, int rows,
               const Control& control) {
  Rings rings;
  rings.view = source.lat_long();
  if (source.cubemap()) {
    const CubemapImage rest{source.columns(), bright.empty() ? std::vector<float>() : pixels_without(bright, source)};
    rings.owned = rings_of_cubemap(bright.empty() ? source.cube() : rest.view(), rows, control);
    rings.view = rings.owned.view();
  } else if (!bright.empty()) {
    rings.owned = {source.columns(), source.rows(), pixels_without(bright, source)};
    rings.view = rings.owned.view();
  }
  return rings;
}

std::size_t cube_rings_bytes(int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  return RingTable::working_bytes(key) + RingTable::making_bytes(key);
}

}  // namespace welkin::reflections
