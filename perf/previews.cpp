#include "perf.h"
#include "tools/preview_light.h"
#include "welkin/bake.h"
#include "welkin/environment_file.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

BakeOptions all_that_previews_show() {
  BakeOptions options;
  options.specular = PrefilterOptions{};
  options.irradiance = IrradianceOptions{};
  options.brdf = BrdfTableOptions{};
  return options;
}

}  // namespace

void add_previews() {
  constexpr double kPixels = 1792.0 * 640.0 + 1024.0 * 512.0 + 1000.0 * 350.0;
  add_benchmark("Previews", "spheres-256", "256", kThreadCounts, kPixels, 0.0, [] {
    const auto folder = scratch_file("previews", [](const auto& path) { std::filesystem::create_directory(path); });
    auto light = std::make_shared<BakeResult>(bake(sky_image({.grain = 0.1})->view(), all_that_previews_show()));
    return [light, folder] {
      const tool::PreviewOptions options{tool::ToneMap{exposure_of(light->background->view(3))}};
      benchmark::DoNotOptimize(tool::write_previews(*light, options, folder));
    };
  });
}

}  // namespace welkin::perf
