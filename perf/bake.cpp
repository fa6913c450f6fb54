#include "welkin/bake.h"

#include "perf.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

/// A lat-long half as high as wide: a sky over ground with clouds of a few sizes, as smooth as photographs are and no
/// smoother; and a sun of 34 000, one degree across. The last one is kept.
std::shared_ptr<const LatLongImage> bake_picture(int width, bool sun) {
  static std::shared_ptr<const LatLongImage> made;
  static bool made_with_sun = false;
  if (made && made->width == width && made_with_sun == sun) return made;
  auto drawn = std::make_shared<LatLongImage>();
  const int height = width / 2;
  const double texel_degrees = 360.0 / width;
  drawn->width = width;
  drawn->height = height;
  drawn->pixels.resize(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::uint32_t state = 1;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double x = 2.0 * M_PI * column / width;
      const double y = M_PI * row / height;
      state = state * 1664525U + 1013904223U;
      const double grain = 0.02 * static_cast<double>(state >> 8U) / (1U << 24U);
      const double clouds = 0.3 * std::sin(5.0 * x) * std::sin(3.0 * y) + 0.15 * std::sin(23.0 * x + 11.0 * y) +
                            0.08 * std::sin(71.0 * x) * std::sin(67.0 * y);
      double value = (row < height / 2 ? 1.0 : 0.3) + clouds * std::sin(y) + grain;
      const double away = texel_degrees * std::hypot((column - 0.29326 * width) * std::sin(y), row - 0.1666 * width);
      if (sun && away < 0.53) value = 34'000.0;
      float* const texel =
          drawn->pixels.data() + std::size_t{3} * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                                   static_cast<std::size_t>(column));
      texel[0] = static_cast<float>(value);
      texel[1] = static_cast<float>(0.9 * value);
      texel[2] = static_cast<float>(0.7 * value + 0.2);
    }
  }
  made_with_sun = sun;
  return made = drawn;
}

/// A chain of `size`, an irradiance cubemap and a BRDF table without sheen.
BakeOptions bake_options(int size, bool background) {
  BakeOptions options;
  options.specular = PrefilterOptions{.size = size};
  if (!background) options.background.reset();
  options.brdf = BrdfTableOptions{.sheen = false};
  return options;
}

enum class Memory { fresh, again };

void add_bake(const std::string& variant, int threads, bool sun, bool background, Memory memory) {
  constexpr double texels = 1024.0 * 512.0;
  add_benchmark("Bake", variant, "1024x512", threads, texels, 12.0 * texels, [=]() -> std::function<void()> {
    auto source = bake_picture(1024, sun);
    auto result = std::make_shared<BakeResult>();
    return [=] {
      if (memory == Memory::fresh) *result = {};
      bake_into(*result, source->view(), bake_options(512, background));
      benchmark::DoNotOptimize(result->irradiance->face(0));
    };
  });
}

/// A chain of `size` from a lat-long of `width`, into memory that is there.
void add_bake_of(int size, int width, int threads) {
  const double texels = 0.5 * width * width;
  const std::string shape = std::to_string(width) + 'x' + std::to_string(width / 2);
  add_benchmark("Bake", std::to_string(size), shape, threads, texels, 12.0 * texels, [=]() -> std::function<void()> {
    auto source = bake_picture(width, false);
    auto result = std::make_shared<BakeResult>();
    return [=] {
      bake_into(*result, source->view(), bake_options(size, false));
      benchmark::DoNotOptimize(result->irradiance->face(0));
    };
  });
}

/// A chain of `size` from a cubemap of that size, a probe that an engine captured.
void add_bake_of_cubemap(PixelFormat format, int size, int threads) {
  const double texels = 6.0 * size * size;
  const double bytes = texels * static_cast<double>(bytes_per_texel(format));
  add_benchmark("Bake", "cube-" + name(format), std::to_string(size), threads, texels, bytes,
                [=]() -> std::function<void()> {
                  const Cubemap picture = to_cubemap(bake_picture(1024, false)->view(), size);
                  auto source = std::make_shared<report::FormattedCubemap>(picture, format);
                  auto result = std::make_shared<BakeResult>();
                  return [=] {
                    bake_into(*result, source->view(), bake_options(size, false));
                    benchmark::DoNotOptimize(result->irradiance->face(0));
                  };
                });
}

constexpr int kMany = 64;

/// What an engine wants of a probe of 64: its harmonics, and five mips as halves. 64 probes in one call, or in single
/// calls of the same.
void add_bake_many(int threads, bool in_one_call) {
  constexpr double texels = 6.0 * 64.0 * 64.0 * kMany;
  const std::string variant = in_one_call ? "rgba16f" : "rgba16f-single-calls";
  add_benchmark("BakeMany", variant, "64x" + std::to_string(kMany), threads, texels, 8.0 * texels,
                [=]() -> std::function<void()> {
                  const Cubemap picture = to_cubemap(bake_picture(1024, false)->view(), 64);
                  auto source = std::make_shared<report::FormattedCubemap>(picture, PixelFormat::rgba16f);
                  const auto room = std::make_shared<const ProbeTargets>(kMany, 64, 5);
                  const PrefilterOptions options{.size = 64, .mips = 5};
                  std::vector<CubemapView> probes(kMany, source->view());
                  std::vector<dvec3> light(std::size_t{9} * kMany);
                  if (in_one_call) {
                    return [=]() mutable {
                      benchmark::DoNotOptimize(bake_many(probes, room->targets, light, options));
                      benchmark::DoNotOptimize(room->memory.data());
                      benchmark::DoNotOptimize(source.get());  // held by being named
                    };
                  }
                  return [=] {
                    for (std::size_t k = 0; k < kMany; ++k) {
                      benchmark::DoNotOptimize(project(probes[k]));
                      const PrefilteredSpecular chain = prefilter_specular(probes[k], options);
                      store_texels(chain.cubemap, std::span(room->targets).subspan(5 * k, 5));
                    }
                    benchmark::DoNotOptimize(room->memory.data());
                    benchmark::DoNotOptimize(source.get());
                  };
                });
}

}  // namespace

void add_bakes(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) {
    add_bake("512", threads, false, false, Memory::fresh);
    add_bake("512-again", threads, false, false, Memory::again);
    add_bake("512-background", threads, false, true, Memory::again);
    add_bake("512-sun", threads, true, false, Memory::again);
    add_bake_of(256, 1024, threads);
    add_bake_of(1024, 2048, threads);
    add_bake_of(2048, 4096, threads);
    add_bake_of(512, 8192, threads);
    for (const int size : {64, 128, 256, 512}) {
      for (const auto format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgba16f})
        add_bake_of_cubemap(format, size, threads);
    }
    add_bake_many(threads, true);
    add_bake_many(threads, false);
  }
}

}  // namespace welkin::perf
