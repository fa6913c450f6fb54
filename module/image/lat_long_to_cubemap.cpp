// The faces of a cubemap from a lat-long: by area, or by samples of a grid on the sphere.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "image/area_resampling.h"
#include "image/pixels.h"
#include "image/sphere_grid.h"
#include "jobs/tiles.h"
#include "welkin/image.h"

namespace welkin::image {
namespace {

constexpr int kTileTexels = 32768;
constexpr int kBlock = 256;  ///< texels that are decoded at a time

SphereGrid grid_of(const LatLongView& source, const Control& control) {
  SphereGrid grid(source.height, source.width, GridContent::samples);
  const std::size_t texel_bytes = bytes_per_texel(source.format);
  const int tile_rows = std::max(1, kTileTexels / source.width);
  const jobs::Placement placement = jobs::placement_for(std::int64_t{source.width} * source.height);
  jobs::run_rows(source.height, tile_rows, placement, jobs::worker_count(placement), control,
                 [&](int row, std::size_t) {
                   const auto* const from = static_cast<const std::byte*>(row_of(source, row));
                   float rgb[3 * kBlock];
                   for (int first = 0; first < source.width; first += kBlock) {
                     const int count = std::min(kBlock, source.width - first);
                     decode_texels(source.format, from + static_cast<std::size_t>(first) * texel_bytes, count, rgb);
                     float* texel = grid.texel(first, row);
                     for (int i = 0; i < count; ++i, texel += 4) {
                       std::copy_n(rgb + 3 * i, 3, texel);
                       texel[3] = 0.0F;
                     }
                   }
                   grid.fill_sides(row, 1);
                 });
  grid.fill_poles();
  return grid;
}

}  // namespace

void fill_cubemap(const LatLongView& source, Cubemap& cubemap, int level, ResampleFilter filter,
                  const Control& control) {
  const int size = cubemap.level_size(level);
  const std::array<float*, 6> faces = faces_of(cubemap, level);
  if (filter == ResampleFilter::area) return fill_cubemap_by_area(source, size, faces, control);
  constexpr double kShareOfCopy = 0.3;
  const SphereGrid grid = grid_of(source, jobs::part_of(control, 0.0, kShareOfCopy));
  sample_faces(grid, size, faces, {}, jobs::part_of(control, kShareOfCopy, 1.0));
}

}  // namespace welkin::image
