// Requests, run at once and by a worker that was made in the caller's environment, and the light of a moving sky.
#include <exception>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "calls.h"
#include "images.h"
#include "support/small_skies.h"
#include "welkin/requests.h"
#include "welkin/resampling.h"
#include "welkin/sky_light.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

void call_requests(Calls& calls) {
  const Cubemap cube = small_cubemap();
  const LatLongImage wide = small_lat_long();
  const glm::dmat3 rotation = rotation_about_y(21.0);
  for (const EnvironmentSource& source : {EnvironmentSource(cube), EnvironmentSource(wide)}) {
    const Project project_source{source, {.target_size = 5}};
    calls.call("Project::operator()(", [&] { return project_source({}); });
    const ToCubemap to_cube{source, 5, rotation};
    calls.call("ToCubemap::operator()(", [&] { return to_cube({}); });
  }
  const ToLatLong to_wide{cube, 8, 4, rotation};
  calls.call("ToLatLong::operator()(", [&] { return to_wide({}); });
  const Bake bake_request{EnvironmentSource(wide), small_bake()};
  calls.call("Bake::operator()(", [&] { return bake_request({}); });
  const BakeTo bake_to_request{EnvironmentSource(wide), {}, small_bake()};
  calls.call("BakeTo::operator()(", [&] { return bake_to_request({}); });

  const PrecomputeSky precompute{earth(), tiny_tables()};
  const auto tables = calls.call("PrecomputeSky::operator()(", [&] { return precompute({}); });
  const glm::dvec3 sun = sun_direction(7.3, 41.0);
  const BakeSkyCurve curve{
      tables, 12.3, {.bands = 3, .nodes = 8, .projection = {.bands = 3, .zeniths = 4, .azimuths = 4}}};
  calls.call("BakeSkyCurve::operator()(", [&] { return curve({}).at(sun); });
  const SkySpecular specular{tables, 12.3, sun, {.size = 8, .roughness = {0.3, 0.9}}};
  calls.call("SkySpecular::operator()(", [&] { return specular({}); });

  calls.call("Worker::Worker(", [&] {
    Worker worker({.threads = 1, .thread_priority = ThreadPriority::normal});
    return worker.post(Project{wide, {.target_size = 7}}).get();
  });
}

/// A light that has come to rest, and what it is then.
struct Settled {
  SphericalHarmonics radiance;
  Sun sun;
  std::vector<glm::dmat3> rotations;
  std::vector<double> weights;
};

void add_bits(BitHash& hash, const Settled& light) {
  test::add_bits(hash, light.radiance, light.sun, light.rotations, light.weights);
}

Settled settle(SkyLight& sky, Worker& worker) {
  while (!sky.update(0.1).settled) {
    if (sky.error()) std::rethrow_exception(sky.error());
    worker.wait_until_idle();
  }
  const SkyLightFrame& frame = sky.light();
  Settled light{frame.radiance, frame.sun, {}, {}};
  for (const SkyReflections& reflections : frame.reflections) {
    light.rotations.push_back(reflections.rotation);
    light.weights.push_back(reflections.weight);
  }
  return light;
}

void call_sky_light(Calls& calls) {
  SkyLightOptions options{.tables = tiny_tables(),
                          .curve = {.bands = 3, .nodes = 8, .projection = {.bands = 3, .zeniths = 4, .azimuths = 4}},
                          .specular = {.size = 8, .roughness = {0.3, 0.9}}};
  const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth(), options.tables));
  Worker worker({.threads = 1, .thread_priority = ThreadPriority::normal});
  const auto settled = [&](SkyLight sky) { return settle(sky, worker); };
  calls.call("SkyLight::SkyLight(Worker&, Atmosphere", [&] { return settled(SkyLight(worker, earth(), options)); });
  calls.call("SkyLight::SkyLight(Worker&, shared_ptr", [&] { return settled(SkyLight(worker, tables, options)); });
  SkyLight sky(worker, tables, options);
  const auto change = [&](const char* name, const auto& work) {
    calls.call(name, [&] {
      work();
      return settle(sky, worker);
    });
  };
  const glm::dvec3 direction(0.36, 0.48, -0.8);
  change("SkyLight::set_sun(double", [&] { sky.set_sun(12.34, 56.78); });
  change("SkyLight::set_sun(dvec3", [&] { sky.set_sun(direction); });
  change("SkyLight::set_intensity(", [&] { sky.set_intensity(1.7); });
  change("SkyLight::set_altitude(", [&] { sky.set_altitude(123.4); });
  change("SkyLight::set_atmosphere(", [&] { sky.set_atmosphere(earth_hillaire()); });
  change("SkyLight::update(", [&] {
    sky.set_sun(44.4, 55.5);
    sky.update(0.123);
  });
}

}  // namespace

void call_worker(Calls& calls) {
  call_requests(calls);
  call_sky_light(calls);
}

}  // namespace welkin::test
