#include "prefilter.h"

#include <cstddef>
#include <string>

#include "subjects.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::perf {
namespace {

constexpr int kWidth = 1024;
constexpr int kHeight = 512;

LatLongImage with_sun() {
  const LatLongView noise = noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight);
  const float* const rgb = static_cast<const float*>(noise.pixels);
  LatLongImage image{kWidth, kHeight, {rgb, rgb + std::size_t{3} * kWidth * kHeight}};
  for (std::size_t c = 0; c < 3; ++c) image.pixels[std::size_t{3} * (150 * kWidth + 300) + c] = 1e6F;
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

}  // namespace

void add_prefilter(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) {
    for (const int size : {256, 512}) {
      add("spectral", size, threads, {.size = size}, false);
      add("spectral-bright", size, threads, {.size = size}, true);
      add("narrow", size, threads, narrow(size), false);
      add("narrow-bright", size, threads, narrow(size), true);
    }
    add_cubemap("cubemap", 256, threads, {.size = 256});
    add_cubemap("cubemap-narrow", 256, threads, narrow(256));
    add("sampled", 256, threads, {.size = 256, .method = PrefilterMethod::sampled, .samples = 64}, false);
  }
}

}  // namespace welkin::perf
