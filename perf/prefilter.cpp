#include "perf.h"
#include "perf/report/passes.h"
#include "welkin/image.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

constexpr int kWidth = 1024;
constexpr int kHeight = 512;

LatLongImage with_sun(bool sun = true) {
  const LatLongView noise = noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight);
  const float* const rgb = static_cast<const float*>(noise.pixels);
  LatLongImage image{kWidth, kHeight, {rgb, rgb + std::size_t{3} * kWidth * kHeight}};
  for (std::size_t c = 0; sun && c < 3; ++c) image.pixels[std::size_t{3} * (150 * kWidth + 300) + c] = 1e6F;
  return image;
}

void add(const std::string& variant, int size, int threads, const PrefilterOptions& options, bool sun) {
  const double texels = 6.0 * size * size * 4.0 / 3.0;
  add_benchmark(
      "Prefilter", variant, std::to_string(size), threads, texels, 12.0 * texels, [=]() -> std::function<void()> {
        if (sun) {
          return [=, image = with_sun()] { benchmark::DoNotOptimize(prefilter_specular(image.view(), options)); };
        }
        const LatLongView view = noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight);
        return [=] { benchmark::DoNotOptimize(prefilter_specular(view, options)); };
      });
}

/// A chain of which no mip is wider than roughness 0.054.
PrefilterOptions narrow(int size) {
  constexpr double widest = 0.054;
  PrefilterOptions options{.size = size};
  const int mips = full_chain_levels(size);
  for (int mip = 1; mip <= mips; ++mip) options.roughness.push_back(widest * mip / mips);
  return options;
}

void add_cubemap(const std::string& variant, int size, int threads, const PrefilterOptions& options) {
  const double texels = 6.0 * size * size * 4.0 / 3.0;
  add_benchmark("Prefilter", variant, std::to_string(size), threads, texels, 12.0 * texels,
                [=]() -> std::function<void()> {
                  const CubemapView view = noise_cubemap(PixelFormat::rgb32f, size);
                  return [=] { benchmark::DoNotOptimize(prefilter_specular(view, options)); };
                });
}

void add_sampled(int size, int threads) {
  const double texels = 6.0 * size * size * 4.0 / 3.0;
  const std::vector<double> roughness =
      mip_roughness(RoughnessSchedule::filament, default_mip_count(RoughnessSchedule::filament, size), size);
  add_benchmark("Prefilter", "sampled", std::to_string(size), threads, texels, 12.0 * texels,
                [=]() -> std::function<void()> {
                  const LatLongView view = noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight);
                  return [=] { benchmark::DoNotOptimize(report::importance_sampled(view, size, roughness, 64)); };
                });
}

/// Charlie sheen as glTF's sample renderer has it.
LobeChainOptions sheen(int size) {
  LobeChainOptions options{.size = size};
  for (const double roughness : charlie_mip_roughness(5, size)) options.lobes.push_back(ZonalLobe::charlie(roughness));
  return options;
}

void add_kernels(int size, int threads) {
  const double texels = 6.0 * size * size * 4.0 / 3.0;
  for (const bool sun : {false, true}) {
    add_benchmark("Prefilter", sun ? "sheen-bright" : "sheen", std::to_string(size), threads, texels, 12.0 * texels,
                  [=]() -> std::function<void()> {
                    return [=, image = with_sun(sun)] {
                      benchmark::DoNotOptimize(prefilter_by_lobes(image.view(), sheen(size)));
                    };
                  });
  }
}

void add_octahedral(int size, int threads) {
  const double texels = 4.0 / 3.0 * size * size;
  add_benchmark(
      "Octahedral", "chain", std::to_string(size), threads, texels, 12.0 * texels, [=]() -> std::function<void()> {
        const auto chain = std::make_shared<Cubemap>(build_mips(noise_cubemap(PixelFormat::rgb32f, size / 2)));
        return [=] { benchmark::DoNotOptimize(to_octahedral(*chain, OctahedralOptions{.size = size, .levels = 5})); };
      });
}

}  // namespace

void add_prefilter(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) {
    for (const int size : {256, 512}) {
      add("spectral", size, threads, {.size = size}, false);
      add("spectral-bright", size, threads, {.size = size}, true);
      add("narrow", size, threads, narrow(size), false);
      add("narrow-bright", size, threads, narrow(size), true);
    }
    add_kernels(256, threads);
    add_octahedral(512, threads);
    add_cubemap("cubemap", 256, threads, {.size = 256});
    add_cubemap("cubemap-narrow", 256, threads, narrow(256));
    add_sampled(256, threads);
  }
}

}  // namespace welkin::perf
