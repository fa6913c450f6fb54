#include "welkin/importance.h"

#include <functional>
#include <memory>
#include <vector>

#include "benchmarks.h"
#include "subjects.h"

namespace welkin::perf {

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
