#include "bake.h"

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "reflections/brdf_table.h"
#include "subjects.h"
#include "welkin/bake.h"
#include "welkin/image.h"

namespace welkin::perf {
namespace {

constexpr int kWidth = 1024;
constexpr int kHeight = 512;

/// A sky over ground with clouds of a few sizes, as smooth as photographs are and no smoother; and a sun of 34 000, one
/// degree across.
std::shared_ptr<const LatLongImage> picture(bool sun) {
  static std::shared_ptr<const LatLongImage> made[2];
  auto& image = made[sun ? 1 : 0];
  if (image) return image;
  auto drawn = std::make_shared<LatLongImage>();
  drawn->width = kWidth;
  drawn->height = kHeight;
  drawn->pixels.resize(std::size_t{3} * kWidth * kHeight);
  std::uint32_t state = 1;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const double x = 2.0 * M_PI * column / kWidth;
      const double y = M_PI * row / kHeight;
      state = state * 1664525U + 1013904223U;
      const double grain = 0.02 * static_cast<double>(state >> 8U) / (1U << 24U);
      const double clouds = 0.3 * std::sin(5.0 * x) * std::sin(3.0 * y) + 0.15 * std::sin(23.0 * x + 11.0 * y) +
                            0.08 * std::sin(71.0 * x) * std::sin(67.0 * y);
      double value = (row < kHeight / 2 ? 1.0 : 0.3) + clouds * std::sin(y) + grain;
      const double away = std::hypot((column - 300.3) * std::sin(y), row - 170.6);
      if (sun && away < 1.5) value = 34'000.0;
      float* const texel = drawn->pixels.data() + std::size_t{3} * static_cast<std::size_t>(row * kWidth + column);
      texel[0] = static_cast<float>(value);
      texel[1] = static_cast<float>(0.9 * value);
      texel[2] = static_cast<float>(0.7 * value + 0.2);
    }
  }
  return image = drawn;
}

BakeOptions chain_of_512(bool background) {
  BakeOptions options;
  options.specular = PrefilterOptions{.size = 512};
  if (!background) options.background.reset();
  options.brdf = BrdfTableOptions{.sheen = false};
  return options;
}

enum class Memory { fresh, again };
enum class Table { warm, cold };

void add_bake(const std::string& variant, int threads, bool sun, bool background, Memory memory, Table table) {
  constexpr double texels = 1.0 * kWidth * kHeight;
  add_benchmark("Bake", variant, "1024x512", threads, texels, 12.0 * texels, [=]() -> std::function<void()> {
    auto source = picture(sun);
    auto result = std::make_shared<BakeResult>();
    return [=] {
      BakeOptions options = chain_of_512(background);
      // The cache cannot be emptied from here: the table is made after the bake, not beside it, which costs the more.
      if (table == Table::cold) options.brdf.reset();
      if (memory == Memory::fresh) *result = {};
      bake_into(*result, source->view(), options);
      if (table == Table::cold) {
        benchmark::DoNotOptimize(reflections::integrated_brdf(BrdfTableOptions{.sheen = false}, {}));
      }
      benchmark::DoNotOptimize(result->irradiance->pixels.data());
    };
  });
}

void add_table(const std::string& variant, int threads, bool sheen) {
  add_benchmark("BrdfTable", variant, "64", threads, 64.0 * 64.0, 0.0, [=]() -> std::function<void()> {
    return [=] { benchmark::DoNotOptimize(reflections::integrated_brdf(BrdfTableOptions{.sheen = sheen}, {})); };
  });
}

}  // namespace

void add_bakes(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) {
    add_bake("512", threads, false, false, Memory::fresh, Table::warm);
    add_bake("512-again", threads, false, false, Memory::again, Table::warm);
    add_bake("512-cold-brdf", threads, false, false, Memory::again, Table::cold);
    add_bake("512-background", threads, false, true, Memory::again, Table::warm);
    add_bake("512-sun", threads, true, false, Memory::again, Table::warm);
    add_table("split_sum", threads, false);
    add_table("split_sum-sheen", threads, true);
  }
}

}  // namespace welkin::perf
