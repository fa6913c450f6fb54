// Bakes, and the savings of finding their results again.
#include "welkin/bake.h"

#include "perf.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"

namespace welkin::perf {
namespace {

/// Returns options for a chain of `size`, an irradiance cubemap and a BRDF table without sheen.
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

/// Adds a chain of `size` from a cubemap of that size, a probe that an engine captured.
void add_bake_of_cubemap(int size) {
  add_bake("cube-rgb32f", std::to_string(size), 6.0 * size * size, bake_options(size), Memory::again,
           [=] { return std::make_shared<const Cubemap>(to_cubemap(sky_image()->view(), size)); });
}

constexpr int kMany = 64;

/// Adds bakes of what an engine needs of a probe of 64: harmonics, and five mips as half floats. 64 probes in one
/// call, or in single calls.
void add_bake_many(bool in_one_call) {
  constexpr double texels = 6.0 * 64.0 * 64.0 * kMany;
  const std::string variant = in_one_call ? "rgba16f" : "rgba16f-single-calls";
  add_benchmark("BakeMany", variant, "64x" + std::to_string(kMany), kThreadCounts, texels, 8.0 * texels, [=] {
    const Cubemap image = to_cubemap(sky_image()->view(), 64);
    const auto source = std::make_shared<const report::FormattedCubemap>(image, PixelFormat::rgba16f);
    const auto out = std::make_shared<const ProbeTargets>(kMany, 64, 5);
    return [=, light = std::vector<dvec3>(std::size_t{9} * kMany)]() mutable {
      const std::vector<CubemapView> probes(kMany, source->view());
      const PrefilterOptions options{.size = 64, .mips = 5};
      if (in_one_call) {
        benchmark::DoNotOptimize(bake_many(probes, out->targets, light, options));
      } else {
        for (std::size_t k = 0; k < kMany; ++k) {
          benchmark::DoNotOptimize(project(probes[k]));
          const PrefilteredSpecular chain = prefilter_specular(probes[k], options);
          store_texels(chain.cubemap, std::span(out->targets).subspan(5 * k, 5));
        }
      }
      benchmark::DoNotOptimize(out->memory.data());
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

/// Returns options for a chain without mips wider than roughness 0.054.
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

namespace {

constexpr int kWidth = 1024;
constexpr int kHeight = 512;
constexpr int kFace = 1024;
constexpr int kThreads[] = {2};

using Body = std::function<void()>;

void add(const std::string& variant, bool cubemap, const std::function<Body()>& prepare) {
  const double texels = cubemap ? 6.0 * kFace * kFace : 1.0 * kWidth * kHeight;
  add_benchmark("Cache", variant, cubemap ? std::to_string(kFace) : "1024x512", kThreads, texels, 12.0 * texels,
                prepare);
}

LatLongView source() { return noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight); }

BakeOptions whole_bake() {
  BakeOptions options;
  options.specular = PrefilterOptions{.size = 256, .roughness = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}};
  return options;
}

/// A cache only on disk, or only in memory; its folder is removed at the end.
struct Cached {
  std::filesystem::path folder;
  ResultCache cache;

  Cached(const std::string& name, bool on_disk)
      : folder(on_disk ? scratch_file(name, [](const auto& path) { std::filesystem::create_directory(path); }) : ""),
        cache({.folder = folder,
               .memory_bytes = on_disk ? 0 : std::uint64_t{256} << 20U,
               .disk_bytes = std::uint64_t{128} << 20U}) {}
  ~Cached() {
    if (!folder.empty()) std::filesystem::remove_all(folder);
  }
  Cached(const Cached&) = delete;
  Cached& operator=(const Cached&) = delete;
};

using Change = void (*)(LatLongImage& image, BakeOptions& options);

/// Bakes with a cache, each time after a change. Without a change the bake is found: a first call, which is not timed,
/// stores it.
void add_cached(const std::string& variant, bool on_disk, Change change) {
  add(variant, false, [=]() -> Body {
    const auto* const noise = static_cast<const float*>(source().pixels);
    const std::ptrdiff_t count = std::ptrdiff_t{3} * kWidth * kHeight;
    auto image = std::make_shared<LatLongImage>(LatLongImage{kWidth, kHeight, {noise, noise + count}});
    auto options = std::make_shared<BakeOptions>(whole_bake());
    auto cached = std::make_shared<Cached>(variant, on_disk);
    return [=] {
      change(*image, *options);
      benchmark::DoNotOptimize(cached->cache.bake(image->view(), *options));
    };
  });
}

void add_bakes_and_hashes() {
  const Change other_image = [](LatLongImage& image, BakeOptions&) { image.pixels.front() += 1.0F; };
  const Change other_mip = [](LatLongImage&, BakeOptions& options) { options.specular->roughness.back() -= 1e-6; };
  const Change none = [](LatLongImage&, BakeOptions&) {};
  add("bake-computed", false,
      []() -> Body { return [image = source()] { benchmark::DoNotOptimize(bake(image, whole_bake())); }; });
  add_cached("bake-first-in-memory", false, other_image);
  add_cached("bake-first-on-disk", true, other_image);
  add_cached("bake-found-in-memory", false, none);
  add_cached("bake-found-on-disk", true, none);
  add_cached("bake-last-mip-changed", false, other_mip);
  add("hash", false, []() -> Body { return [image = source()] { benchmark::DoNotOptimize(hash_pixels(image)); }; });
}

void add_cubemaps() {
  const auto view = [] { return noise_cubemap(PixelFormat::rgb32f, kFace); };
  add("cubemap-hash", true,
      [=]() -> Body { return [cubemap = view()] { benchmark::DoNotOptimize(hash_pixels(cubemap)); }; });
  add("cubemap-projected", true,
      [=]() -> Body { return [cubemap = view()] { benchmark::DoNotOptimize(project(cubemap)); }; });
  for (const bool changed : {true, false}) {
    add(changed ? "cubemap-face-changed" : "cubemap-faces-added-up", true, [=]() -> Body {
      auto kept = std::make_shared<FaceHarmonics>(project_faces(view()));
      return [kept, changed, cubemap = view()] {
        if (changed) update_faces(*kept, cubemap, std::array{2});
        benchmark::DoNotOptimize(combine(*kept));
      };
    });
  }
}

}  // namespace

void add_result_cache() {
  add_bakes_and_hashes();
  add_cubemaps();
}

}  // namespace welkin::perf
