// The machine's own limit: reading as many bytes as a projection reads, and doing nothing with them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "benchmarks.h"
#include "image/image_kernels.h"
#include "jobs/tiles.h"
#include "subjects.h"

namespace welkin::perf {
namespace {

constexpr std::int64_t kTileBytes = std::int64_t{512} << 10U;  // about a projection tile
constexpr std::int64_t kGroupBytes = 64;

/// Reads `bytes` bytes in tiles, inline or as tasks just like the projection does.
std::function<void()> reader(const void* pixels, std::int64_t bytes, std::int64_t texels) {
  const jobs::Placement placement = jobs::placement_for(texels);
  const std::int64_t groups = bytes / kGroupBytes;
  const std::int64_t tile_groups = kTileBytes / kGroupBytes;
  const auto tiles = static_cast<std::size_t>((groups + tile_groups - 1) / tile_groups);
  return [=] {
    std::vector<float> sums(tiles);
    jobs::run_tiles(tiles, placement, jobs::worker_count(placement), {}, [&](std::size_t tile, std::size_t) {
      const std::int64_t first = static_cast<std::int64_t>(tile) * tile_groups;
      sums[tile] = image::image_kernels().read_all(static_cast<const float*>(pixels) + first * 16,
                                                   std::min(tile_groups, groups - first));
    });
    benchmark::DoNotOptimize(sums.data());
  };
}

}  // namespace

void add_read_bandwidth(const std::vector<int>& sizes, const std::vector<int>& thread_counts) {
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgba16f}) {
    for (const int size : sizes) {
      for (const int threads : thread_counts) {
        const std::int64_t texels = std::int64_t{6} * size * size;
        const std::int64_t bytes = texels * static_cast<std::int64_t>(bytes_per_texel(format));
        add_benchmark("ReadBandwidth", name(format), std::to_string(size), threads, static_cast<double>(texels),
                      static_cast<double>(bytes),
                      [=] { return reader(noise_cubemap(format, size).faces[0], bytes, texels); });
      }
    }
  }
  for (const int threads : thread_counts) {
    constexpr int width = 4096;
    constexpr int height = 2048;
    constexpr std::int64_t texels = std::int64_t{width} * height;
    constexpr std::int64_t bytes = texels * 12;
    add_benchmark("ReadBandwidth", "rgb32f", "4096x2048", threads, static_cast<double>(texels),
                  static_cast<double>(bytes),
                  [=] { return reader(noise_lat_long(PixelFormat::rgb32f, width, height).pixels, bytes, texels); });
  }
}

}  // namespace welkin::perf
