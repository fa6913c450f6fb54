// Promise: a curve over the sun's elevation gives what the projection gives, for a fraction of it.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "sky/curve_nodes.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "support/thrown_error.h"
#include "welkin/control.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/instruction_set.h"
#include "welkin/sky_harmonics.h"

namespace welkin::test {
namespace {

double difference(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  return relative_difference(a.coefficients(), b.coefficients());
}

/// The worst of many suns with elevations between two.
double worst(const SkyCurve& curve, const SkyProjector& projector, double low, double high) {
  std::mt19937 random(static_cast<unsigned>(1000.0 + high));
  double result = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double elevation = low + (high - low) * static_cast<double>(random()) * 0x1p-32;
    const glm::dvec3 sun = sun_direction(elevation, static_cast<double>(random()) * 0x1p-32 * 360.0);
    result = std::max(result, difference(curve.at(sun), projector.project(sun)));
  }
  return result;
}

}  // namespace

TEST_CASE("a curve gives the projection at any elevation", "[sky][curve]") {
  const SkyView view(small_earth(), 0.0);
  for (const int bands : {1, 3, 9}) {
    CAPTURE(bands);
    SkyCurveOptions options;
    options.bands = bands;
    const SkyCurve curve(view, options);
    SkyHarmonicsOptions projection = options.projection;
    projection.bands = bands;
    const SkyProjector projector(view, projection);
    CHECK(curve.bands() == bands);
    CHECK(worst(curve, projector, 10.0, 90.0) < 5e-4);
    CHECK(worst(curve, projector, -6.0, 10.0) < 1e-3);
    CHECK(worst(curve, projector, -12.0, -6.0) < 5e-2);
  }
}

TEST_CASE("more nodes make a better curve", "[sky][curve]") {
  const SkyView view(small_earth(), 0.0);
  const SkyProjector projector(view, SkyCurveOptions{}.projection);
  SkyCurveOptions options;
  options.nodes = 16;
  const double coarse = worst(SkyCurve(view, options), projector, -6.0, 90.0);
  options.nodes = 512;
  CHECK(worst(SkyCurve(view, options), projector, -6.0, 90.0) < 0.2 * coarse);
}

TEST_CASE("curves hold aloft and in space", "[sky][curve]") {
  for (const double altitude : {1.8, 3000.0, 40'000.0, 4e5, 6e7}) {
    CAPTURE(altitude);
    const SkyView view(small_earth(), altitude);
    SkyCurveOptions options;
    options.projection.zeniths = 12;
    options.projection.azimuths = 12;
    const SkyCurve curve(view, options);
    const SkyProjector projector(view, options.projection);
    double brightest = 0.0;
    double most = 0.0;
    for (double elevation = -90.0; elevation <= 90.0; elevation += 7.3) {
      const glm::dvec3 sun = sun_direction(elevation, 3.0);
      const SphericalHarmonics truth = projector.project(sun);
      const SphericalHarmonics light = curve.at(sun);
      for (std::size_t k = 0; k < 9; ++k) {
        for (int c = 0; c < 3; ++c)
          most = std::max(most, std::abs(light.coefficients()[k][c] - truth.coefficients()[k][c]));
      }
      brightest = std::max(brightest, truth.at(0, 0).y);
    }
    CHECK(most < 1e-2 * brightest);
  }
}

TEST_CASE("a curve's band 0 and sun are never negative", "[sky][curve]") {
  const SkyView view(small_earth(), 0.0);
  for (const int nodes : {8, 9, 64}) {
    SkyCurveOptions options;
    options.nodes = nodes;
    const SkyCurve curve(view, options);
    for (double elevation = -90.0; elevation <= 90.0; elevation += 0.037) {
      const glm::dvec3 sun = sun_direction(elevation, 0.0);
      const SphericalHarmonics light = curve.at(sun);
      const glm::dvec3 direct = curve.sun_irradiance(sun);
      for (int c = 0; c < 3; ++c) {
        REQUIRE(light.at(0, 0)[c] >= 0.0);
        REQUIRE(direct[c] >= 0.0);
      }
    }
    CHECK(curve.sun_irradiance(sun_direction(-50.0, 0.0)) == glm::dvec3(0.0));
  }
}

TEST_CASE("a curve's sun is the view's", "[sky][curve]") {
  for (const double altitude : {0.0, 9000.0}) {
    const SkyView view(small_earth(), altitude);
    const SkyCurve curve(view);
    const double full = view.sun(sun_direction(90.0, 0.0)).irradiance.y;
    for (double elevation = -4.0; elevation <= 90.0; elevation += 0.21) {
      CAPTURE(altitude, elevation);
      const glm::dvec3 sun = sun_direction(elevation, 12.0);
      const glm::dvec3 expected = view.sun(sun).irradiance;
      for (int c = 0; c < 3; ++c) {
        CHECK(std::abs(curve.sun_irradiance(sun)[c] - expected[c]) < 2e-3 * expected[c] + 2e-4 * full);
      }
    }
  }
}

TEST_CASE("near the zenith nothing depends on which way the sun leans", "[sky][curve]") {
  const SkyCurve curve(SkyView(small_earth(), 0.0), {.bands = 8});
  const SphericalHarmonics zenith = curve.at(glm::dvec3(0, 1, 0));
  for (const double lean : {1e-3, 1e-8, 1e-16, 1e-300}) {
    for (const glm::dvec3& sun : {glm::dvec3(lean, 1, 0), glm::dvec3(0, 1, -lean), glm::dvec3(-lean, 1, lean)}) {
      CHECK(difference(curve.at(sun), zenith) < 5.0 * lean + 1e-12);
    }
  }
}

TEST_CASE("a curve turns with the sun", "[sky][curve]") {
  const SkyCurve curve(SkyView(small_earth(), 0.0), {.bands = 16});
  const SphericalHarmonics ahead = curve.at(sun_direction(23.0, 0.0));
  for (const double azimuth : {17.0, 90.0, -145.0, 180.0}) {
    const double half = 0.5 * azimuth * std::numbers::pi / 180.0;
    const glm::dquat turn(std::cos(half), 0.0, std::sin(half), 0.0);
    CHECK(difference(curve.at(sun_direction(23.0, azimuth)), rotate(ahead, turn)) < 1e-12);
  }
}

TEST_CASE("a curve is the same bits on any number of threads and instruction set", "[sky][curve][determinism]") {
  const SkyView view(small_earth(), 120.0);
  const auto sample = [&] {
    SkyCurveOptions options;
    options.nodes = 33;
    options.projection.zeniths = 9;
    options.projection.azimuths = 10;
    const SkyCurve curve(view, options);
    std::vector<glm::dvec3> all;
    for (double elevation = -40.0; elevation <= 90.0; elevation += 3.3) {
      const SphericalHarmonics light = curve.at(sun_direction(elevation, 20.0));
      all.insert(all.end(), light.coefficients().begin(), light.coefficients().end());
      all.push_back(curve.sun_irradiance(sun_direction(elevation, 20.0)));
    }
    return all;
  };
  std::vector<glm::dvec3> expected;
  run_with_threads(1, [&] { expected = sample(); });
  const auto check = [&] {
    const std::vector<glm::dvec3> now = sample();
    CHECK(same_bytes(std::span<const glm::dvec3>(now), std::span<const glm::dvec3>(expected)));
  };
  for (const int threads : {2, 5}) run_with_threads(threads, check);
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    check();
  }
  force_instruction_set(before);
}

TEST_CASE("asking a curve allocates nothing, nor does a tile of its bake", "[sky][curve]") {
  const SkyView view(small_earth(), 0.0);
  forget_allocations_in_tiles();
  const SkyCurve curve(view);
  CHECK(allocations_in_tiles() == 0);
  SphericalHarmonics light(3);
  const FailingHeap heap(Heap::this_thread, 1, true);
  curve.at(glm::dvec3(0.1, 0.2, 0.3), light.coefficients());
  (void)curve.sun_irradiance(glm::dvec3(0.1, 0.2, 0.3));
  CHECK_FALSE(heap.failed());
}

TEST_CASE("a curve's bake is cancelled, tells its progress, and refuses nonsense", "[sky][curve]") {
  const SkyView view(small_earth(), 0.0);
  std::stop_source source;
  source.request_stop();
  CHECK(thrown_by([&] { SkyCurve(view, {}, {.stop = source.get_token()}); }).code == ErrorCode::cancelled);
  double last = 0.0;
  const SkyCurve curve(view, {}, {.progress = [&](double share) {
                         CHECK(share >= last);
                         last = share;
                       }});
  CHECK(last == 1.0);
  for (const int nodes : {7, 4097, -1}) {
    CHECK(thrown_by([&] { SkyCurve(view, {.nodes = nodes}); }).says(std::to_string(nodes) + " nodes"));
  }
  CHECK(thrown_by([&] { SkyCurve(view, {.bands = 17}); }).says("bands"));
  std::vector<glm::dvec3> eight(8);
  CHECK(thrown_by([&] { curve.at(glm::dvec3(0, 1, 0), eight); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)curve.sun_irradiance(glm::dvec3(0.0)); }).code == ErrorCode::invalid_argument);
}

TEST_CASE("a curve's axis goes there and back, and is finest at the horizon", "[sky][curve]") {
  for (const double horizon : {0.0, -0.05, -0.9}) {
    for (const double lowest : {-1.0, -0.95}) {
      const sky::CurveAxis axis(101, lowest, horizon);
      CHECK(axis.sine(0) == Approx(lowest));
      CHECK(axis.sine(100) == 1.0);
      double finest = 2.0;
      double where = 0.0;
      for (int node = 0; node < 100; ++node) {
        const double step = axis.sine(node + 1) - axis.sine(node);
        CHECK(step > 0.0);
        if (step < finest) {
          finest = step;
          where = axis.sine(node);
        }
        const auto place = axis.place(0.5 * (axis.sine(node) + axis.sine(node + 1)));
        CHECK(place.interval == node);
      }
      CHECK(std::abs(where - horizon) < 0.02);
      CHECK(axis.place(-2.0).interval == 0);
    }
  }
}

}  // namespace welkin::test
