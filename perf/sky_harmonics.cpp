#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "benchmarks.h"
#include "perf/report/passes.h"
#include "subjects.h"
#include "welkin/sky.h"
#include "welkin/sky_light.h"

namespace welkin::perf {
namespace {

/// A sun that climbs from 5 to 65 degrees and turns, over and over; no two the same, and no libm in the loop.
class MovingSun {
 public:
  glm::dvec3 next() {
    step_ = (step_ + 1) % 1024;
    const double part = static_cast<double>(step_) / 1024.0;
    return {0.2 + part, 0.1 + 1.5 * part, 1.0 - part};
  }

 private:
  int step_ = 0;
};

void add_projection(const report::SkySetting& setting) {
  add_benchmark("SkyHarmonics", setting.name, setting.directions, 1, 1.0, 0.0, [=]() -> std::function<void()> {
    const auto projector = std::make_shared<const SkyProjector>(SkyView(earth_tables(), 0.0), setting.options);
    const auto light = std::make_shared<SphericalHarmonics>(setting.options.bands);
    const auto sun = std::make_shared<MovingSun>();
    return [=] { projector->project(sun->next(), light->coefficients()); };
  });
}

/// They would be made beside it, on the worker: here the frame's own cost is asked for.
SkyLightOptions without_reflections() {
  SkyLightOptions options;
  options.specular.size = 0;
  return options;
}

void add_curve(int bands) {
  add_benchmark("SkyCurve", "at", std::to_string(bands), 1, 1.0, 0.0, [=]() -> std::function<void()> {
    const auto curve = std::make_shared<const SkyCurve>(SkyView(earth_tables(), 0.0), SkyCurveOptions{.bands = bands});
    const auto light = std::make_shared<SphericalHarmonics>(bands);
    const auto sun = std::make_shared<MovingSun>();
    return [=] { curve->at(sun->next(), light->coefficients()); };
  });
}

}  // namespace

void add_sky_harmonics(const std::vector<int>& thread_counts) {
  for (const report::SkySetting& setting : report::sky_settings()) add_projection(setting);
  for (const int bands : {1, 3, 9, 16}) add_curve(bands);
  for (const int threads : thread_counts) {
    add_benchmark("SkyCurve", "bake", std::to_string(SkyCurveOptions{}.nodes), threads, 1.0, 0.0,
                  [=]() -> std::function<void()> {
                    const auto view = std::make_shared<const SkyView>(earth_tables(), 0.0);
                    return [=] { benchmark::DoNotOptimize(SkyCurve(*view)); };
                  });
  }
  add_benchmark("SkyLight", "update", "3", 1, 1.0, 0.0, [=]() -> std::function<void()> {
    struct DynamicSky {
      Worker worker{WorkerOptions{.threads = 1}};
      SkyLight sky;
      MovingSun sun;
      DynamicSky() : sky(worker, earth_tables(), without_reflections()) {}
    };
    const auto dynamic = std::make_shared<DynamicSky>();
    while (!dynamic->sky.update(1.0).settled) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return [=] {
      dynamic->sky.set_sun(dynamic->sun.next());
      dynamic->sky.update(0.016);
    };
  });
}

}  // namespace welkin::perf
