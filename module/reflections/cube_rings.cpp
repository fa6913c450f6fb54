#include "reflections/cube_rings.h"

#include <cstddef>
#include <utility>

#include "image/pixels.h"
#include "reflections/ring_table.h"

namespace welkin::reflections {

Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  const std::size_t floats = std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows);
  Rings rings{{}, platform::AlignedBuffer<float>(floats)};
  rings.view = {rings.owned.data(), 2 * rows, rows, 0, PixelFormat::rgb32f};
  RingTable::get({source.size, rows}, {control.stop})->fill(source, rings.owned.data(), control);
  return rings;
}

Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright, int rows,
               const Control& control) {
  if (!source.cubemap() && bright.empty()) return {source.lat_long(), {}};
  if (bright.empty()) return rings_of_cubemap(source.cube(), rows, control);
  platform::AlignedBuffer<float> rest = pixels_without(bright, source);
  if (source.cubemap()) return rings_of_cubemap(image::packed_cubemap(rest.data(), source.columns()), rows, control);
  const LatLongView view{rest.data(), source.columns(), source.rows(), 0, PixelFormat::rgb32f};
  return {view, std::move(rest)};
}

std::size_t cube_rings_bytes(int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  return RingTable::working_bytes(key) + RingTable::making_bytes(key);
}

}  // namespace welkin::reflections
