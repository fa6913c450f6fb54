#include "welkin/sky.h"

#include "perf.h"
#include "sky/table_sizes.h"
#include "welkin/bake.h"

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
    // More and less haze in turn: what it does not change is kept.
    add_benchmark("SkyTables", "compact-haze", "4", threads, 1.0, 0.0, []() -> std::function<void()> {
      return [more = false]() mutable {
        more = !more;
        Atmosphere air = earth_bruneton();
        for (double& value : air.aerosol.scattering_per_m) value *= more ? 1.5 : 1.0;
        SkyTableOptions options;
        options.layout = ScatteringLayout::compact;
        options.sun_zeniths = 32;
        benchmark::DoNotOptimize(precompute_sky(air, options));
      };
    });
  }
}

namespace {

void add_making() {
  for (const double altitude : {0.0, 2000.0}) {
    add_benchmark("SkyView", "full", std::to_string(static_cast<int>(altitude)), 1, 1.0, 0.0,
                  [=]() -> std::function<void()> {
                    return [=] { benchmark::DoNotOptimize(SkyView(earth_tables(), altitude)); };
                  });
  }
}

void add_specular(int threads) {
  constexpr double texels = 6.0 * 32.0 * 32.0;
  add_benchmark("SkySpecular", "no_disc", "32", threads, texels, 12.0 * texels, []() -> std::function<void()> {
    const auto view = std::make_shared<const SkyView>(earth_tables(), 0.0);
    return [=] { benchmark::DoNotOptimize(sky_specular(*view, sun_direction(20.0, 30.0), {.size = 32})); };
  });
}

}  // namespace

void add_sky_views(const std::vector<int>& thread_counts) {
  add_making();
  for (const int threads : thread_counts) add_specular(threads);
}

}  // namespace welkin::perf
