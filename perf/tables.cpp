#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks.h"
#include "projection/lat_long_projection.h"
#include "projection/texel_weights.h"
#include "subjects.h"
#include "welkin/importance.h"

namespace welkin::perf {

void add_tables() {
  for (const int size : {16, 64, 128}) {
    for (const int bands : {3, 10}) {
      const projection::TexelWeightsKey key{size, bands, false, size};
      const double texels = 6.0 * size * size;
      const std::string suffix = "-bands" + std::to_string(bands);
      add_benchmark(
          "TexelWeights", "cold" + suffix, std::to_string(size), 1, texels, 0.0,
          [=]() -> std::function<void()> { return [=] { benchmark::DoNotOptimize(projection::TexelWeights(key)); }; });
      add_benchmark("TexelWeights", "warm" + suffix, std::to_string(size), 1, texels, 0.0,
                    [=]() -> std::function<void()> {
                      return [=] { benchmark::DoNotOptimize(projection::TexelWeights::get(key)); };
                    });
    }
  }
  const projection::LatLongWeightsKey key{4096, 2048, 3, false, 0};
  constexpr double texels = 4096.0 * 2048.0;
  add_benchmark("LatLongWeights", "cold-bands3", "4096x2048", 1, texels, 0.0, [=]() -> std::function<void()> {
    return [=] { benchmark::DoNotOptimize(projection::LatLongWeights(key)); };
  });
  add_benchmark("LatLongWeights", "warm-bands3", "4096x2048", 1, texels, 0.0, [=]() -> std::function<void()> {
    return [=] { benchmark::DoNotOptimize(projection::LatLongWeights::get(key)); };
  });
}

void add_importance(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) {
    // Read once; a function and a cumulative distribution written.
    constexpr double texels = 4096.0 * 2048.0;
    add_benchmark(
        "ImportanceTable", "rgb32f", "4096x2048", threads, texels, 20.0 * texels, [=]() -> std::function<void()> {
          const LatLongView view = noise_lat_long(PixelFormat::rgb32f, 4096, 2048);
          const auto table = std::make_shared<ImportanceTable>(importance_table(view));
          return [=] {
            benchmark::DoNotOptimize(importance_table(view, {table->function, table->row_cdf, table->column_cdf}));
          };
        });
  }
}

}  // namespace welkin::perf
