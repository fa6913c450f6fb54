#include <string>

#include "benchmarks.h"
#include "sky/table_sizes.h"
#include "subjects.h"
#include "welkin/sky.h"

namespace welkin::perf {

void add_sky_tables(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) {
    for (const ScatteringLayout layout : {ScatteringLayout::full, ScatteringLayout::compact}) {
      for (const int orders : {1, 4}) {
        SkyTableOptions options;
        options.layout = layout;
        options.orders = orders;
        if (layout == ScatteringLayout::compact) options.sun_zeniths = 32;
        const auto texels = static_cast<double>(sky::scattering_texels(options));
        add_benchmark("SkyTables", layout == ScatteringLayout::full ? "full" : "compact", std::to_string(orders),
                      threads, texels, 0.0, [=]() -> std::function<void()> {
                        return [=] { benchmark::DoNotOptimize(precompute_sky(earth_bruneton(), options)); };
                      });
      }
    }
    const SkyTableOptions least{.heights = 2, .view_zeniths = 4, .sun_zeniths = 4, .sun_angles = 2, .orders = 1};
    add_benchmark("SkyTransmittance", "table", "64x256", threads, 64.0 * 256.0, 0.0, [=]() -> std::function<void()> {
      return [=] { benchmark::DoNotOptimize(precompute_sky(earth_bruneton(), least)); };
    });
  }
}

}  // namespace welkin::perf
