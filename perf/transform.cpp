#include <memory>
#include <string>

#include "benchmarks.h"
#include "subjects.h"
#include "transform/ring_fft.h"
#include "transform/ring_legendre.h"
#include "transform/spectrum.h"

namespace welkin::perf {
namespace {

constexpr int kWidth = 1024;
constexpr int kHeight = 512;
constexpr double kTexels = 1.0 * kWidth * kHeight;

void add_synthesis(int bands, int threads, image::GridContent content) {
  const transforms::GridSize size = transforms::grid_for_bands(bands);
  const double texels = 1.0 * size.rings * size.columns;
  const bool spline = content == image::GridContent::spline_coefficients;
  add_benchmark("Synthesise", std::to_string(bands) + (spline ? "-spline" : "-samples"),
                std::to_string(size.columns) + "x" + std::to_string(size.rings), threads, texels, 16.0 * texels,
                [=]() -> std::function<void()> {
                  const LatLongView view = noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight);
                  const auto spectrum = std::make_shared<transforms::Spectrum>(transforms::analyse(view, bands, {}));
                  const auto grid = std::make_shared<image::SphereGrid>(size.rings, size.columns, content);
                  const std::vector<double> zonal(static_cast<std::size_t>(bands), 1.0);
                  return [=] { transforms::synthesise(*spectrum, zonal, *grid, {}); };
                });
}

}  // namespace

void add_transform(const std::vector<int>& thread_counts) {
  const std::string size = std::to_string(kWidth) + "x" + std::to_string(kHeight);
  for (const int bands : {64, 128, 256, 384, 512}) {
    for (const int threads : thread_counts) {
      add_benchmark("Analyse", std::to_string(bands), size, threads, kTexels, 12.0 * kTexels,
                    [=]() -> std::function<void()> {
                      const LatLongView view = noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight);
                      return [=] { benchmark::DoNotOptimize(transforms::analyse(view, bands, {})); };
                    });
      add_synthesis(bands, threads, image::GridContent::samples);
      add_synthesis(bands, threads, image::GridContent::spline_coefficients);
    }
    add_benchmark("TransformTables", std::to_string(bands), size, 1, kTexels, 0.0, [=]() -> std::function<void()> {
      return [=] {
        benchmark::DoNotOptimize(transforms::LegendreFactors(bands));
        benchmark::DoNotOptimize(transforms::LegendreRings({kHeight, bands, transforms::RingPlaces::edges}));
        benchmark::DoNotOptimize(transforms::RingFourier(kWidth));
      };
    });
  }
}

}  // namespace welkin::perf
