#include "specular/lobe_splats.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "image/texel_geometry.h"
#include "jobs/tiles.h"

namespace welkin::specular {
namespace {

constexpr std::int64_t kTileWork = 1 << 16;  ///< texels times lights: some 50 microseconds

simd::LobeRow lobe_row(int face, int size, int row, double alpha) {
  const image::Frame& frame = image::face_frame(face);
  const double v = (2.0 * row + 1.0) / size - 1.0;
  simd::LobeRow result{};
  for (int axis = 0; axis < 3; ++axis) {
    result.base[axis] = static_cast<float>(frame.normal[axis] + v * frame.v[axis]);
    result.along[axis] = static_cast<float>(frame.u[axis]);
  }
  result.step = static_cast<float>(1.0 / size);
  result.count = size;
  result.alpha_squared = static_cast<float>(alpha * alpha);
  result.half_slope = static_cast<float>(0.25 * (1.0 - alpha * alpha));
  return result;
}

}  // namespace

void add_lobe_lights(std::span<const simd::LobeLight> lights, double alpha, int size,
                     const std::array<float*, 6>& faces, const Control& control) {
  if (lights.empty()) return;
  const std::int64_t row_work = static_cast<std::int64_t>(size) * static_cast<std::int64_t>(lights.size());
  const int rows = 6 * size;
  const int rows_per_tile = static_cast<int>(std::clamp<std::int64_t>(kTileWork / row_work, 1, rows));
  const int tiles = (rows + rows_per_tile - 1) / rows_per_tile;
  const auto placement = jobs::placement_for(rows * row_work / 4);
  const simd::Kernels& kernels = simd::active_kernels();
  jobs::run_tiles(static_cast<std::size_t>(tiles), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    const int first = static_cast<int>(tile) * rows_per_tile;
                    for (int row = first; row < std::min(rows, first + rows_per_tile); ++row) {
                      const int face = row / size;
                      float* const rgb =
                          faces[static_cast<std::size_t>(face)] + std::ptrdiff_t{3} * size * (row % size);
                      kernels.add_lobes(lobe_row(face, size, row % size, alpha), lights.data(),
                                        static_cast<int>(lights.size()), rgb);
                    }
                  });
}

}  // namespace welkin::specular
