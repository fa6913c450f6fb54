#include "welkin/bake.h"

#include "perf.h"
#include "welkin/image.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

/// A chain of `size`, an irradiance cubemap and a BRDF table without sheen.
BakeOptions bake_options(int size, bool background = false) {
  BakeOptions options;
  options.specular = PrefilterOptions{.size = size};
  if (!background) options.background.reset();
  options.brdf = BrdfTableOptions{.sheen = false};
  return options;
}

enum class Memory { fresh, again };

/// `make()`: a shared image.
template <class Make>
void add_bake(const std::string& variant, const std::string& shape, double texels, const BakeOptions& options,
              Memory memory, const Make& make) {
  add_benchmark("Bake", variant, shape, kThreadCounts, texels, 12.0 * texels, [=] {
    return [=, source = make(), result = std::make_shared<BakeResult>()] {
      if (memory == Memory::fresh) *result = {};
      bake_into(*result, source->view(), options);
      benchmark::DoNotOptimize(result->irradiance->face(0));
    };
  });
}

void add_bake_of_lat_long(const std::string& variant, const SkyImageOptions& image, const BakeOptions& options,
                          Memory memory = Memory::again) {
  const std::string shape = std::to_string(image.width) + 'x' + std::to_string(image.width / 2);
  add_bake(variant, shape, 0.5 * image.width * image.width, options, memory, [=] { return sky_image(image); });
}

/// A chain of `size` from a cubemap of that size, a probe that an engine captured.
void add_bake_of_cubemap(int size) {
  add_bake("cube-rgb32f", std::to_string(size), 6.0 * size * size, bake_options(size), Memory::again,
           [=] { return std::make_shared<const Cubemap>(to_cubemap(sky_image()->view(), size)); });
}

constexpr int kMany = 64;

/// What an engine wants of a probe of 64: its harmonics, and five mips as halves. 64 probes in one call, or in single
/// calls of the same.
void add_bake_many(bool in_one_call) {
  constexpr double texels = 6.0 * 64.0 * 64.0 * kMany;
  const std::string variant = in_one_call ? "rgba16f" : "rgba16f-single-calls";
  add_benchmark("BakeMany", variant, "64x" + std::to_string(kMany), kThreadCounts, texels, 8.0 * texels, [=] {
    const Cubemap image = to_cubemap(sky_image()->view(), 64);
    const auto source = std::make_shared<const report::FormattedCubemap>(image, PixelFormat::rgba16f);
    const auto room = std::make_shared<const ProbeTargets>(kMany, 64, 5);
    return [=, light = std::vector<dvec3>(std::size_t{9} * kMany)]() mutable {
      const std::vector<CubemapView> probes(kMany, source->view());
      const PrefilterOptions options{.size = 64, .mips = 5};
      if (in_one_call) {
        benchmark::DoNotOptimize(bake_many(probes, room->targets, light, options));
      } else {
        for (std::size_t k = 0; k < kMany; ++k) {
          benchmark::DoNotOptimize(project(probes[k]));
          const PrefilteredSpecular chain = prefilter_specular(probes[k], options);
          store_texels(chain.cubemap, std::span(room->targets).subspan(5 * k, 5));
        }
      }
      benchmark::DoNotOptimize(room->memory.data());
    };
  });
}

}  // namespace

void add_bakes() {
  add_bake_of_lat_long("512", {}, bake_options(512), Memory::fresh);
  add_bake_of_lat_long("512-background", {}, bake_options(512, true));
  add_bake_of_lat_long("512-sun", {.sun = 34'000.0}, bake_options(512));
  add_bake_of_lat_long("256", {}, bake_options(256));
  add_bake_of_lat_long("1024", {.width = 2048}, bake_options(1024));
  add_bake_of_lat_long("2048", {.width = 4096}, bake_options(2048));
  add_bake_of_lat_long("512", {.width = 8192}, bake_options(512));
  for (const int size : {64, 128, 256, 512}) add_bake_of_cubemap(size);
  add_bake_many(true);
  add_bake_many(false);
}

namespace {

void add_prefilter_of(const std::string& variant, bool cubemap, const PrefilterOptions& options) {
  const double texels = 6.0 * options.size * options.size * 4.0 / 3.0;
  add_benchmark("Prefilter", variant, std::to_string(options.size), kThreadCounts, texels, 12.0 * texels, [=] {
    const EnvironmentView view = cubemap ? EnvironmentView(noise_cubemap(PixelFormat::rgb32f, options.size))
                                         : EnvironmentView(noise_lat_long(PixelFormat::rgb32f, 1024, 512));
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

}  // namespace

void add_prefilter() {
  for (const int size : {256, 512}) {
    add_prefilter_of("spectral", false, {.size = size});
    add_prefilter_of("narrow", false, narrow(size));
  }
  add_prefilter_of("cubemap", true, {.size = 256});
  add_prefilter_of("cubemap-narrow", true, narrow(256));
}

}  // namespace welkin::perf
