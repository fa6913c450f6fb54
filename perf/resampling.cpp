#include "welkin/resampling.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks.h"
#include "image/pixels.h"
#include "image/sphere_grid.h"
#include "jobs/tiles.h"
#include "subjects.h"
#include "welkin/projection.h"

namespace welkin::perf {
namespace {

constexpr double kTexelBytes = 12.0;

double cube_texels(int size) { return 6.0 * size * size; }

/// Copies a cubemap in tiles, as the passes do: the yardstick for what reads and writes.
void add_copy(int size, int threads) {
  const double texels = cube_texels(size);
  add_benchmark("CopyBandwidth", "rgb32f", std::to_string(size), threads, texels, 2.0 * kTexelBytes * texels,
                [=]() -> std::function<void()> {
                  const auto* const from = static_cast<const float*>(noise_cubemap(PixelFormat::rgb32f, size).faces[0]);
                  const auto to = std::make_shared<std::vector<float>>(static_cast<std::size_t>(3.0 * texels));
                  return [=] {
                    constexpr std::size_t tile = std::size_t{1} << 16U;
                    const auto where = jobs::Placement::arena;
                    jobs::run_tiles((to->size() + tile - 1) / tile, where, jobs::worker_count(where), {},
                                    [&](std::size_t index, std::size_t) {
                                      const std::size_t first = index * tile;
                                      const std::size_t count = std::min(tile, to->size() - first);
                                      std::memcpy(to->data() + first, from + first, count * sizeof(float));
                                    });
                  };
                });
}

void add_lat_long_to_cubemap(int width, int size, int threads) {
  const int height = width / 2;
  const double bytes = kTexelBytes * (cube_texels(size) + 1.0 * width * height);
  const std::string shape = std::to_string(width) + "x" + std::to_string(height) + "-" + std::to_string(size);
  for (const ResampleFilter filter : {ResampleFilter::area, ResampleFilter::bilinear}) {
    add_benchmark("LatLongToCubemap", filter == ResampleFilter::area ? "area" : "bilinear", shape, threads,
                  cube_texels(size), bytes, [=]() -> std::function<void()> {
                    const LatLongView view = noise_lat_long(PixelFormat::rgb32f, width, height);
                    const auto chain = std::make_shared<Cubemap>(size, 1);
                    return [=] { image::fill_cubemap(view, *chain, 0, filter, {}); };
                  });
  }
}

void add_sample_grid(int size, int threads) {
  const int rings = 2 * size;
  const int columns = 4 * size;
  const double bytes = kTexelBytes * cube_texels(size) + 16.0 * rings * columns;
  add_benchmark(
      "SampleGrid", "spline", std::to_string(size), threads, cube_texels(size), bytes, [=]() -> std::function<void()> {
        const auto grid = std::make_shared<image::SphereGrid>(rings, columns, image::GridContent::spline_coefficients);
        for (int ring = 0; ring < rings; ++ring) std::fill_n(grid->texel(0, ring), 4 * columns, 0.5F);
        grid->fill_sides(0, rings);
        grid->fill_poles();
        const auto chain = std::make_shared<Cubemap>(size, 1);
        return [=] { image::sample_faces(*grid, size, image::faces_of(*chain, 0), {}, {}); };
      });
}

void add_mips(int size, int threads) {
  // A level's texels are read once and a quarter as many written; all levels together 4/3 of that.
  const double bytes = kTexelBytes * cube_texels(size) * 1.25 * 4.0 / 3.0;
  for (const MipFilter filter : {MipFilter::box, MipFilter::solid_angle}) {
    add_benchmark("Mips", filter == MipFilter::box ? "box" : "solid_angle", std::to_string(size), threads,
                  cube_texels(size), bytes, [=]() -> std::function<void()> {
                    const auto chain = std::make_shared<Cubemap>(size, full_chain_levels(size));
                    for (int face = 0; face < 6; ++face) {
                      const auto values = static_cast<std::size_t>(cube_texels(size) / 2.0);
                      std::fill_n(chain->face(0, face), values, 0.5F);
                    }
                    return [=] { fill_mips(*chain, filter); };
                  });
  }
}

void add_irradiance_cubemap(int bands, int size, int threads) {
  add_benchmark("IrradianceCubemap", std::to_string(bands), std::to_string(size), threads, cube_texels(size),
                kTexelBytes * cube_texels(size), [=]() -> std::function<void()> {
                  return [irradiance = SphericalHarmonics(bands), size] {
                    benchmark::DoNotOptimize(irradiance_cubemap(irradiance, size));
                  };
                });
}

}  // namespace

void add_resampling(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) {
    for (const int size : {256, 512}) {
      add_copy(size, threads);
      add_lat_long_to_cubemap(2 * size, size, threads);
      add_sample_grid(size, threads);
      add_mips(size, threads);
    }
    add_irradiance_cubemap(3, 64, threads);
  }
}

}  // namespace welkin::perf
