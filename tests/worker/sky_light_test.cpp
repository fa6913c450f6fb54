// Promise: a dynamic sky recomputes only what a change requires, never stalls a frame, and changes without pops.
#include "welkin/sky_light.h"

#include "support/catch.h"
#include "support/heap.h"
#include "support/jobs.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "support/thrown_error.h"
#include "welkin/requests.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

SkyLightOptions quick() {
  SkyLightOptions options{.tables = tiny_tables()};
  options.curve.nodes = 24;
  options.curve.projection.zeniths = 6;
  options.curve.projection.azimuths = 6;
  options.specular.size = 8;
  options.blend_seconds = 0.5;
  return options;
}

/// Updates by frames of `seconds` until no work is pending; returns false after a time limit.
bool settle(SkyLight& sky, double seconds = 1.0 / 60.0) {
  return eventually([&] { return sky.update(seconds).settled; });
}

bool same(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  return same_bytes(a.coefficients(), b.coefficients());
}

std::shared_ptr<const SkyTables> tiny_sky() {
  static const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth(), tiny_tables()));
  return tables;
}

double largest_step(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  double step = 0.0;
  for (std::size_t k = 0; k < a.coefficients().size(); ++k) {
    for (int c = 0; c < 3; ++c) step = std::max(step, std::abs(a.coefficients()[k][c] - b.coefficients()[k][c]));
  }
  return step;
}

}  // namespace

TEST_CASE("at rest a dynamic sky is what the direct calls give", "[dynamic_sky]") {
  Worker worker(options_with(2));
  const SkyLightOptions options = quick();
  SkyLight sky(worker, earth(), options);
  CHECK_FALSE(sky.light().ready);
  sky.set_sun(31.0, 200.0);
  REQUIRE(settle(sky));
  const SkyLightFrame& frame = sky.light();
  CHECK(frame.ready);
  const glm::dvec3 sun = frame.sun.direction;
  CHECK(glm::distance(sun, sun_direction(31.0, 200.0)) < 1e-14);
  const SkyView view(tiny_sky(), 0.0);
  const SkyCurve curve(view, options.curve);
  CHECK(same(frame.radiance, curve.at(sun)));
  CHECK(same_bits(frame.sun.irradiance, curve.sun_irradiance(sun)));
  CHECK(frame.sun.solid_angle == Approx(view.sun_light(sun).solid_angle).epsilon(1e-6));
  REQUIRE(frame.reflections[0].specular);
  CHECK(frame.reflections[0].weight == 1.0);
  CHECK_FALSE(frame.reflections[1].specular);
  const auto expected = SkySpecular{tiny_sky(), 0.0, sun, options.specular}({});
  CHECK(same_bits(frame.reflections[0].specular->cubemap, expected->cubemap));
  CHECK(sky.error() == nullptr);
  CHECK(sky.counters().tables_baked == 1);
  CHECK(sky.counters().curves_baked == 1);
}

TEST_CASE("a sun that only turns makes no work", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLight sky(worker, tiny_sky(), quick());
  sky.set_sun(20.0, 0.0);
  REQUIRE(settle(sky));
  const SkyLightCounters before = sky.counters();
  const SphericalHarmonics ahead = sky.light().radiance;
  for (int degrees = 1; degrees <= 360; ++degrees) {
    sky.set_sun(20.0, degrees);
    REQUIRE(sky.update(1.0 / 60.0).settled);
  }
  sky.set_sun(20.0, 90.0);
  const SkyLightFrame& frame = sky.update(0.0);
  const SkyLightCounters after = sky.counters();
  CHECK(after.posts == before.posts);
  CHECK(after.rotations == before.rotations + 361);
  CHECK(after.elevations == before.elevations);
  CHECK(after.speculars_baked == before.speculars_baked);
  const double half = std::sqrt(0.5);
  CHECK(relative_difference(frame.radiance.coefficients(),
                            rotate(ahead, glm::dquat(half, 0.0, half, 0.0)).coefficients()) < 1e-12);
  // Light that came from +z now comes from +x.
  CHECK(glm::distance(frame.reflections[0].rotation * glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)) < 1e-12);
  CHECK(glm::distance(frame.reflections[0].rotation * glm::dvec3(0, 1, 0), glm::dvec3(0, 1, 0)) < 1e-15);
}

TEST_CASE("intensity is a factor, and what is below the threshold is nothing", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLight sky(worker, tiny_sky(), quick());
  sky.set_sun(50.0, 10.0);
  REQUIRE(settle(sky));
  const SkyLightFrame before = sky.light();
  const SkyLightCounters counters = sky.counters();
  sky.set_intensity(4.0);
  const SkyLightFrame& brighter = sky.update(0.01);
  CHECK(same(brighter.radiance, scale(before.radiance, glm::dvec3(4.0))));
  CHECK(brighter.sun.irradiance == 4.0 * before.sun.irradiance);
  CHECK(brighter.reflections[0].weight == 4.0);
  CHECK(sky.counters().intensities == 1);
  CHECK(sky.counters().posts == counters.posts);
  const std::uint64_t lights = sky.counters().lights;
  sky.set_intensity(4.0);
  sky.set_sun(50.004, 10.004);
  sky.set_sun(50.0, 10.0);
  sky.update(0.01);
  CHECK(sky.counters().moves_ignored == counters.moves_ignored + 1);
  CHECK(sky.counters().intensities == 1);
  CHECK(sky.counters().lights == lights);
  // Small steps accumulate.
  for (int step = 1; step <= 10; ++step) sky.set_sun(50.0 + 0.004 * step, 10.0);
  CHECK(sky.counters().elevations > counters.elevations);
}

TEST_CASE("a rising sun takes its light from the curve at once, and reflections later", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLight sky(worker, tiny_sky(), quick());
  sky.set_sun(20.0, 0.0);
  REQUIRE(settle(sky));
  const SkyLightCounters before = sky.counters();
  const SkyCurve curve(SkyView(tiny_sky(), 0.0), quick().curve);
  sky.set_sun(20.3, 0.0);
  sky.update(0.01);
  CHECK(same(sky.light().radiance, curve.at(sky.light().sun.direction)));
  CHECK(sky.counters().reflections_skipped == before.reflections_skipped + 1);
  CHECK(sky.counters().posts == before.posts);
  sky.set_sun(25.0, 0.0);
  sky.update(0.01);
  CHECK(same(sky.light().radiance, curve.at(sky.light().sun.direction)));
  REQUIRE(settle(sky));
  CHECK(sky.counters().speculars_baked == before.speculars_baked + 1);
  CHECK(sky.counters().curves_baked == before.curves_baked);
  CHECK(sky.counters().tables_baked == 0);
}

TEST_CASE("of a storm of moves the last one wins, and few are worked on", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLight sky(worker, tiny_sky(), quick());
  REQUIRE(settle(sky));
  const SkyLightCounters before = sky.counters();
  {
    Hold hold(worker);  // its only thread
    for (int k = 0; k < 500; ++k) {
      sky.set_sun(-10.0 + 0.19 * k, 3.0 * k);
      if (k % 10 == 0) sky.set_altitude(10.0 * k);
    }
    sky.set_altitude(77.0);
    sky.set_sun(12.0, 34.0);
    CHECK(sky.counters().posts == before.posts + 1);
    CHECK_FALSE(sky.update(0.01).settled);
    hold.let_go();
  }
  REQUIRE(settle(sky));
  const SkyLightCounters after = sky.counters();
  CHECK(after.curves_baked == before.curves_baked + 1);
  CHECK(after.speculars_baked == before.speculars_baked + 1);
  const SkyCurve curve(SkyView(tiny_sky(), 77.0), quick().curve);
  CHECK(same(sky.light().radiance, curve.at(sky.light().sun.direction)));
  CHECK(glm::distance(sky.light().sun.direction, sun_direction(12.0, 34.0)) < 1e-14);
}

TEST_CASE("a sun that never rests still gets new reflections", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLightOptions options = quick();
  options.blend_seconds = 0.0;
  SkyLight sky(worker, tiny_sky(), options);
  REQUIRE(settle(sky));
  const std::uint64_t before = sky.counters().speculars_baked;
  double elevation = 0.0;
  CHECK(eventually([&] {
    elevation = elevation > 80.0 ? 0.0 : elevation + 0.7;
    sky.set_sun(elevation, 0.0);
    sky.update(0.016);
    return sky.counters().speculars_baked >= before + 3;
  }));
}

TEST_CASE("an atmosphere that changes every frame still gets new light", "[dynamic_sky][slow]") {
  Worker worker(options_with(1));
  SkyLightOptions options = quick();
  options.tables.heights = 12;  // many of this test's frames
  options.tables.view_zeniths = 32;
  options.tables.sun_zeniths = 32;
  options.tables.orders = 4;
  options.blend_seconds = 0.0;
  SkyLight sky(worker, earth(), options);
  sky.set_sun(20.0, 0.0);
  double albedo = 0.0;
  int changes = 0;
  SphericalHarmonics last = sky.light().radiance;
  CHECK(eventually([&] {
    albedo = albedo > 0.98 ? 0.0 : albedo + 0.001;
    sky.set_atmosphere(with_ground_albedo(earth(), albedo));
    const SkyLightFrame& frame = sky.update(0.016);
    if (frame.ready && !same(frame.radiance, last)) {
      last = frame.radiance;
      ++changes;
    }
    return changes >= 4 && sky.counters().speculars_baked >= 3;
  }));
  // Tables use the settings at their start; started work is cancelled at most once before each of them.
  const SkyLightCounters counters = sky.counters();
  CHECK(counters.cancelled <= counters.tables_baked + 1);
  CHECK(counters.curves_baked + 1 >= counters.tables_baked);
  REQUIRE(settle(sky));
  const auto tables =
      std::make_shared<const SkyTables>(precompute_sky(with_ground_albedo(earth(), albedo), options.tables));
  CHECK(same(sky.light().radiance, SkyCurve(SkyView(tables, 0.0), options.curve).at(sky.light().sun.direction)));
  const auto specular = SkySpecular{tables, 0.0, sky.light().sun.direction, options.specular}({});
  REQUIRE(sky.light().reflections[0].specular);
  CHECK(same_bits(sky.light().reflections[0].specular->cubemap, specular->cubemap));
}

TEST_CASE("light stays finite for the brightest intensity, the smallest disc and the longest direction",
          "[dynamic_sky]") {
  Worker worker(options_with(1));
  auto point_like = std::make_shared<SkyTables>(*tiny_sky());
  point_like->atmosphere.sun_angular_radius_degrees = 1e-150;
  SkyLight sky(worker, point_like, quick());
  REQUIRE(settle(sky));
  CHECK(thrown_by([&] { sky.set_intensity(1e308); }).code == ErrorCode::invalid_argument);
  sky.set_intensity(1e12);
  sky.set_sun(glm::dvec3(1e308, 1e308, -1e308));
  const SkyLightFrame& frame = sky.update(0.0);
  CHECK(glm::distance(frame.sun.direction, glm::normalize(glm::dvec3(1.0, 1.0, -1.0))) < 1e-14);
  CHECK(frame.sun.irradiance[1] > 1e9);
  for (int c = 0; c < 3; ++c) {
    CHECK(std::isfinite(frame.sun.radiance[c]));
    CHECK(std::isfinite(frame.radiance.coefficients()[0][c]));
    CHECK(std::isfinite(SkyView(point_like, 0.0).sun_light({0.0, 1.0, 0.0}).radiance[c]));
  }
}

TEST_CASE("nothing pops when altitude or atmosphere change", "[dynamic_sky]") {
  Worker worker(options_with(2));
  SkyLight sky(worker, tiny_sky(), quick());
  sky.set_sun(15.0, 0.0);
  REQUIRE(settle(sky));
  const SphericalHarmonics from = sky.light().radiance;
  SECTION("altitude") { sky.set_altitude(8000.0); }
  SECTION("atmosphere") { sky.set_atmosphere(with_ground_albedo(without_aerosol(earth()), 0.9)); }
  constexpr double frame_seconds = 1.0 / 60.0;
  std::vector<SphericalHarmonics> frames{from};
  REQUIRE(eventually([&] {
    frames.push_back(sky.update(frame_seconds).radiance);
    const SkyLightFrame& frame = sky.light();
    CHECK(frame.reflections[0].weight + frame.reflections[1].weight == Approx(1.0));
    return frame.settled;
  }));
  const double whole = largest_step(from, frames.back());
  CHECK(whole > 0.0);
  double largest = 0.0;
  for (std::size_t k = 1; k < frames.size(); ++k) largest = std::max(largest, largest_step(frames[k - 1], frames[k]));
  CHECK(largest <= whole * (frame_seconds / quick().blend_seconds) * (1.0 + 1e-9));
}

TEST_CASE("a new atmosphere stops what is made for the old one", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLightOptions options = quick();
  options.tables.heights = 32;
  options.tables.view_zeniths = 256;
  options.tables.sun_zeniths = 64;
  options.tables.sun_angles = 16;
  options.tables.orders = 40;  // would take minutes
  SkyLight sky(worker, earth(), options);
  REQUIRE(eventually([&] { return worker.load().running == 1; }));
  const auto start = std::chrono::steady_clock::now();
  sky.set_atmosphere(mars());
  REQUIRE(eventually([&] { return sky.counters().cancelled == 1; }));
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(30));
  CHECK_FALSE(sky.light().ready);
}

TEST_CASE("a dynamic sky may go while its jobs run, and so may the worker's work", "[dynamic_sky]") {
  Worker worker(options_with(1));
  for (int k = 0; k < 20; ++k) {
    SkyLight sky(worker, earth(), quick());
    sky.set_sun(k, k);
    if (k % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(k));
    sky.update(0.01);
  }
  worker.wait_until_idle();
  CHECK(worker.load().jobs == 0);
  SkyLight sky(worker, earth(), quick());
  worker.terminate();
  REQUIRE(eventually([&] { return sky.error() != nullptr || sky.update(0.01).ready; }));
  sky.set_altitude(100.0);
  CHECK(thrown_by([&] { std::rethrow_exception(sky.error()); }).code == ErrorCode::stopped);
  sky.update(0.01);  // goes on with the light that it has
  CHECK_FALSE(sky.light().settled);
}

TEST_CASE("an update allocates nothing and never waits", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLight sky(worker, tiny_sky(), quick());
  sky.set_sun(20.0, 0.0);
  REQUIRE(settle(sky));
  sky.set_altitude(500.0);  // curves and reflections to blend while the heap is watched
  worker.wait_until_idle();
  const FailingHeap heap(Heap::this_thread, 1, true);
  bool blended = false;
  for (int k = 0; k < 100; ++k) {
    sky.set_sun(20.0, k);
    sky.set_intensity(1.0 + k);
    blended = blended || sky.update(0.01).reflections[1].specular != nullptr;
  }
  CHECK_FALSE(heap.failed());
  CHECK(blended);
}

TEST_CASE("what a bake throws reaches the caller, and what was there stays", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLightOptions options = quick();
  options.specular.rms_error = -1.0;  // the prefilter refuses that
  SkyLight sky(worker, tiny_sky(), options);
  REQUIRE(eventually([&] { return sky.error() != nullptr; }));
  CHECK(thrown_by([&] { std::rethrow_exception(sky.error()); }).code == ErrorCode::invalid_argument);
  CHECK(eventually([&] { return sky.update(0.01).ready; }));
  CHECK(sky.counters().failures == 1);
  CHECK_FALSE(sky.light().reflections[0].specular);
  sky.set_sun(10.0, 0.0);  // another try
  REQUIRE(eventually([&] { return sky.counters().failures == 2; }));
}

TEST_CASE("the same atmosphere and nearly the same altitude are nothing new", "[dynamic_sky]") {
  Worker worker(options_with(1));
  SkyLight sky(worker, tiny_sky(), quick());
  REQUIRE(settle(sky));
  const SkyLightCounters before = sky.counters();
  sky.set_atmosphere(tiny_sky()->atmosphere);
  Atmosphere renamed = tiny_sky()->atmosphere;
  renamed.name = "home";
  sky.set_atmosphere(renamed);
  for (int step = 0; step < 9; ++step) sky.set_altitude(0.1 * step);
  CHECK(sky.update(0.01).settled);
  CHECK(sky.counters().posts == before.posts);
  CHECK(sky.counters().moves_ignored == before.moves_ignored + 8);
  sky.set_altitude(1.5);
  CHECK(sky.counters().posts > before.posts);
}

TEST_CASE("what a full worker lets go of is asked for again", "[dynamic_sky]") {
  Worker worker(options_with(1, {.max_jobs = 1}));
  std::unique_ptr<SkyLight> sky;
  {
    Hold hold(worker);
    sky = std::make_unique<SkyLight>(worker, tiny_sky(), quick());
    CHECK(thrown_by([&] { std::rethrow_exception(sky->error()); }).code == ErrorCode::stopped);
    CHECK_FALSE(sky->update(0.01).settled);
    hold.let_go();
  }
  worker.wait_until_idle();
  // Steps follow each other while the previous post still counts: each is repeated until it is accepted.
  CHECK(eventually([&] {
    sky->set_intensity(1.0);
    return sky->update(0.1).settled;
  }));
  CHECK(sky->light().ready);
}

TEST_CASE("what is posted behind a dynamic sky does not wait for its tables", "[dynamic_sky]") {
  for (const int threads : {1, 2}) {
    Worker worker(options_with(threads));
    Hold hold(worker, threads);
    SkyLight sky(worker, earth(), quick());
    auto tables = worker.post([&sky](const Control&) { return sky.counters().tables_baked; });
    auto failing = worker.post([](const Control&) -> int { throw std::runtime_error("a job that passes"); });
    hold.let_go();
    CHECK(tables.get() == 0);
    REQUIRE(settle(sky));
    CHECK(outcome(failing) == "a job that passes");
    CHECK_FALSE(sky.error());

    SkyLight alone(worker, tiny_sky(), quick());
    REQUIRE(settle(alone));
    CHECK(same(sky.light().radiance, alone.light().radiance));
  }
}

TEST_CASE("what has a lower priority than a dynamic sky waits for its tables", "[dynamic_sky]") {
  Worker worker(options_with(1));
  Hold hold(worker);
  SkyLight sky(worker, earth(), quick());
  auto tables =
      worker.post([&sky](const Control&) { return sky.counters().tables_baked; }, {.priority = TaskPriority::low});
  hold.let_go();
  CHECK(tables.get() == 1);
}

TEST_CASE("dynamic skies refuse nonsense at once", "[dynamic_sky]") {
  Worker worker(options_with(1));
  const auto refused = [&](const auto& change) {
    SkyLightOptions options = quick();
    change(options);
    return thrown_by([&] { const SkyLight sky(worker, earth(), options); }).code == ErrorCode::invalid_argument;
  };
  CHECK(refused([](SkyLightOptions& options) { options.altitude_m = -1.0; }));
  CHECK(refused([](SkyLightOptions& options) { options.blend_seconds = NAN; }));
  CHECK(refused([](SkyLightOptions& options) { options.curve.bands = 0; }));
  CHECK(refused([](SkyLightOptions& options) { options.curve.nodes = 2; }));
  CHECK(refused([](SkyLightOptions& options) { options.specular.size = -1; }));
  CHECK(refused([](SkyLightOptions& options) { options.sun_threshold_degrees = -0.1; }));
  CHECK(refused([](SkyLightOptions& options) { options.tables.heights = 0; }));
  SkyLight sky(worker, tiny_sky(), quick());
  const auto invalid = [](const auto& call) { return thrown_by(call).code == ErrorCode::invalid_argument; };
  CHECK(invalid([&] { sky.set_sun(91.0, 0.0); }));
  CHECK(invalid([&] { sky.set_sun(NAN, 0.0); }));
  CHECK(invalid([&] { sky.set_sun(0.0, INFINITY); }));
  CHECK(invalid([&] { sky.set_sun(glm::dvec3(0.0)); }));
  CHECK(invalid([&] { sky.set_intensity(-1.0); }));
  CHECK(invalid([&] { sky.set_altitude(NAN); }));
  CHECK(invalid([&] { sky.update(-0.1); }));
  CHECK(refused([](SkyLightOptions& options) { options.altitude_threshold_m = -1.0; }));
  CHECK(refused([](SkyLightOptions& options) { options.curve.projection.zeniths = 1; }));
  CHECK(invalid([&] { sky.set_atmosphere(earth({450.0, 500.0, 550.0, 600.0})); }));
  CHECK(invalid([&] { sky.set_atmosphere(Atmosphere{}); }));
  CHECK(invalid([&] { const SkyLight none(worker, std::shared_ptr<const SkyTables>(), quick()); }));
  CHECK(invalid([&] { (void)SkySpecular{}(Control{}); }));
}

}  // namespace welkin::test
