#include "tables.h"

#include <string>

#include "projection/lat_long_projection.h"
#include "projection/texel_weights.h"
#include "subjects.h"

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

}  // namespace welkin::perf
