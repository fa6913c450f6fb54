#include "welkin/result_cache.h"

#include "perf.h"
#include "welkin/bake.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::perf {
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

/// A cache on disk alone, or in memory alone; its folder is gone in the end.
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

/// Bakes by a cache, each time after a change. Without one the bake is found: a first call, which is not timed, keeps
/// it.
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
