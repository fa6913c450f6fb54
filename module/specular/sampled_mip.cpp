#include "specular/sampled_mip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "image/texel_geometry.h"
#include "jobs/tiles.h"

namespace welkin::specular {
namespace {

constexpr std::int64_t kTileTaps = 8192;  ///< texels times taps: some 0.3 ms

void sample_texel(const PaddedCube& source, const std::vector<Tap>& taps, const glm::dvec3& normal, float* rgb) {
  // Any two axes across it will do.
  const glm::dvec3 up = std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(up, normal));
  const glm::vec3 x(across);
  const glm::vec3 y(glm::cross(normal, across));
  const glm::vec3 z(normal);
  float sum[4] = {};
  for (const Tap& tap : taps) {
    source.add({tap.x * x.x + tap.y * y.x + tap.z * z.x, tap.x * x.y + tap.y * y.y + tap.z * z.y,
                tap.x * x.z + tap.y * y.z + tap.z * z.z},
               tap.level, tap.weight, sum);
  }
  std::copy_n(sum, 3, rgb);
}

}  // namespace

void sample_mip(const PaddedCube& source, const std::vector<Tap>& taps, int size, const std::array<float*, 6>& faces,
                const Control& control) {
  const std::int64_t texels = std::int64_t{6} * size * size;
  const auto taps_in_all = texels * static_cast<std::int64_t>(taps.size());
  const std::int64_t per_tile = std::clamp<std::int64_t>(kTileTaps / static_cast<std::int64_t>(taps.size()), 1, texels);
  const auto placement = jobs::placement_for(taps_in_all * 50);
  jobs::run_tiles(static_cast<std::size_t>((texels + per_tile - 1) / per_tile), placement,
                  jobs::worker_count(placement), control, [&](std::size_t tile, std::size_t /*worker*/) {
                    const std::int64_t first = static_cast<std::int64_t>(tile) * per_tile;
                    for (std::int64_t texel = first; texel < std::min(texels, first + per_tile); ++texel) {
                      const auto face = static_cast<int>(texel / (std::int64_t{size} * size));
                      const auto place = static_cast<int>(texel % (std::int64_t{size} * size));
                      const int row = place / size;
                      const glm::dvec3 normal = image::face_direction(size, face, place % size + 0.5, row + 0.5);
                      sample_texel(source, taps, normal,
                                   faces[static_cast<std::size_t>(face)] + std::ptrdiff_t{3} * place);
                    }
                  });
}

}  // namespace welkin::specular
