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
    const SkyTableOptions least{.heights = 2, .view_zeniths = 4, .sun_zeniths = 4, .sun_angles = 2, .orders = 1};
    add_benchmark("SkyTransmittance", "table", "64x256", threads, 64.0 * 256.0, 0.0, [=]() -> std::function<void()> {
      return [=] { benchmark::DoNotOptimize(precompute_sky(earth_bruneton(), least)); };
    });
  }
}

namespace {

constexpr double kTexelBytes = 12.0;

/// Directions spread evenly over the sphere along a spiral.
std::vector<glm::vec3> spiral(int count) {
  std::vector<glm::vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / count;
    const glm::dvec3 level = sun_direction(0.0, 137.50776 * i);
    const glm::dvec3 towards = std::sqrt(1.0 - y * y) * level + glm::dvec3(0.0, y, 0.0);
    directions.emplace_back(towards);
  }
  return directions;
}

void add_radiance(const std::string& variant, double altitude, int count) {
  add_benchmark("SkyRadiance", variant, std::to_string(count), 1, count, kTexelBytes * count,
                [=]() -> std::function<void()> {
                  const auto view = std::make_shared<const SkyView>(earth_tables(), altitude);
                  const auto directions = std::make_shared<const std::vector<glm::vec3>>(spiral(count));
                  const auto rgb = std::make_shared<std::vector<glm::vec3>>(directions->size());
                  const glm::dvec3 sun = sun_direction(20.0, 30.0);
                  if (variant == "single") {
                    return [=] {
                      for (const glm::vec3& towards : *directions) {
                        benchmark::DoNotOptimize(view->radiance(glm::dvec3(towards), sun));
                      }
                    };
                  }
                  return [=] { view->radiance(*directions, sun, *rgb); };
                });
}

void add_making() {
  for (const double altitude : {0.0, 2000.0}) {
    add_benchmark("SkyView", "full", std::to_string(static_cast<int>(altitude)), 1, 1.0, 0.0,
                  [=]() -> std::function<void()> {
                    return [=] { benchmark::DoNotOptimize(SkyView(earth_tables(), altitude)); };
                  });
  }
}

void add_pictures(int threads) {
  const auto add = [=](const std::string& subject, const std::string& variant, int size, double texels,
                       const std::function<void(const SkyView&, const glm::dvec3&)>& work) {
    add_benchmark(subject, variant, std::to_string(size), threads, texels, kTexelBytes * texels,
                  [=]() -> std::function<void()> {
                    const auto view = std::make_shared<const SkyView>(earth_tables(), 0.0);
                    return [=] { work(*view, sun_direction(20.0, 30.0)); };
                  });
  };
  for (const int size : {32, 256}) {
    for (const bool disc : {false, true}) {
      add("SkyCubemap", disc ? "disc" : "no_disc", size, 6.0 * size * size,
          [=](const SkyView& view, const glm::dvec3& sun) {
            benchmark::DoNotOptimize(sky_cubemap(view, sun, size, {.sun_disc = disc}));
          });
    }
  }
  add("SkyLatLong", "no_disc", 512, 2.0 * 512 * 512,
      [](const SkyView& view, const glm::dvec3& sun) { benchmark::DoNotOptimize(sky_lat_long(view, sun, 512)); });
  add("SkySpecular", "no_disc", 32, 6.0 * 32 * 32, [](const SkyView& view, const glm::dvec3& sun) {
    benchmark::DoNotOptimize(sky_specular(view, sun, {.size = 32}));
  });
}

}  // namespace

void add_sky_views(const std::vector<int>& thread_counts) {
  for (const int count : {1, 64, 512, 4096}) add_radiance("batch", 0.0, count);
  add_radiance("single", 0.0, 512);
  add_radiance("space", 400'000.0, 512);
  add_making();
  for (const int threads : thread_counts) add_pictures(threads);
}

}  // namespace welkin::perf
