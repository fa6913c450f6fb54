#include "previews.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "scratch_files.h"
#include "subjects.h"
#include "tools/previews.h"
#include "welkin/bake.h"

namespace welkin::perf {

LatLongImage picture_of_previews() {
  constexpr int kWidth = 1024;
  constexpr int kHeight = 512;
  LatLongImage image{kWidth, kHeight, {}};
  std::uint32_t state = 1;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      state = state * 1664525U + 1013904223U;
      const double grain = 0.1 * static_cast<double>(state >> 8U) / (1U << 24U);
      const double clouds =
          0.3 * std::sin(0.03 * column) * std::sin(0.02 * row) + 0.1 * std::sin(0.4 * column + 0.3 * row);
      const double value = (row < kHeight / 2 ? 1.0 : 0.3) + clouds + grain;
      for (const double share : {1.0, 0.9, 0.7}) image.pixels.push_back(static_cast<float>(share * value));
    }
  }
  return image;
}

namespace {

BakeOptions all_that_previews_show() {
  BakeOptions options;
  options.specular = PrefilterOptions{};
  options.irradiance = IrradianceOptions{};
  options.brdf = BrdfTableOptions{};
  return options;
}

}  // namespace

void add_previews(const std::vector<int>& thread_counts) {
  constexpr double kPixels = 1792.0 * 640.0 + 1024.0 * 512.0 + 1000.0 * 350.0;
  for (const int threads : thread_counts) {
    add_benchmark("Previews", "balls-256", "256", threads, kPixels, 0.0, []() -> std::function<void()> {
      const auto folder = scratch_file("previews", [](const auto& path) { std::filesystem::create_directory(path); });
      auto light = std::make_shared<BakeResult>(bake(picture_of_previews().view(), all_that_previews_show()));
      return [light, folder] {
        const tool::PreviewOptions options{tool::tone_map_of(light->background->view(3))};
        benchmark::DoNotOptimize(tool::write_previews(*light, options, folder));
      };
    });
  }
}

}  // namespace welkin::perf
