#include "reflections/cube_rings.h"

#include <cstddef>
#include <utility>

#include "image/pixels.h"
#include "reflections/ring_table.h"
#include "welkin/resampling.h"

namespace welkin::reflections {

Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control) {
  const std::size_t floats = std::size_t{6} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows);
  Rings rings{{}, platform::AlignedBuffer<float>(floats)};
  rings.view = {rings.owned.data(), 2 * rows, rows, 0, PixelFormat::rgb32f};
  RingTable::get({source.size, rows}, {control.stop})->fill(source, rings.owned.data(), control);
  return rings;
}

Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright, int rows,
               const Control& control, int face_size) {
  if (!source.cubemap() && bright.empty()) return {source.lat_long(), {}};
  platform::AlignedBuffer<float> rest;
  if (!bright.empty()) rest = pixels_without(bright, source);
  if (source.cubemap()) {
    const CubemapView whole = bright.empty() ? source.cube() : image::packed_cubemap(rest.data(), source.columns());
    if (face_size == 0 || face_size == source.columns()) return rings_of_cubemap(whole, rows, control);
    const CubemapImage smaller = to_cubemap(whole, face_size, glm::dmat3(1.0), {control.stop, {}});
    return rings_of_cubemap(smaller.view(), rows, control);
  }
  const LatLongView view{rest.data(), source.columns(), source.rows(), 0, PixelFormat::rgb32f};
  return {view, std::move(rest)};
}

std::size_t cube_rings_bytes(int face_size, int rows) {
  const RingTableKey key{face_size, rows};
  return RingTable::working_bytes(key) + RingTable::making_bytes(key);
}

}  // namespace welkin::reflections
