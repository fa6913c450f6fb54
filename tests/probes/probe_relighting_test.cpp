// Another environment for probes that were captured.
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <vector>

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/thrown_error.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

/// An environment of so many bands that is nowhere dark.
SphericalHarmonics made_up(int bands, double seed) {
  SphericalHarmonics light(bands);
  for (std::size_t k = 0; k < light.coefficients().size(); ++k) {
    const double number = std::sin(seed + 3.7 * static_cast<double>(k));
    light.coefficients()[k] = dvec3(0.3 * number, 0.2 * number * number, -0.25 * number);
  }
  light.at(0, 0) = dvec3(8.0, 7.0, 9.0);
  return light;
}

const ProbeGrid kGrid{.counts = {3, 2, 2}, .spacing = {1, 1, 1}};

/// What a probe sees through a window in front of it; walls are lit from elsewhere.
bool sees_sky(std::size_t probe, const dvec3& d) {
  const double turn = 0.5 * static_cast<double>(probe);
  return d.y > 0.1 && std::sin(turn) * d.x + std::cos(turn) * d.z > -0.6;
}

Captures captured(const SphericalHarmonics& environment) {
  return {kGrid.size(), 64,
          [&](std::size_t probe, const dvec3& d) {
            return sees_sky(probe, d) ? evaluate(environment, d) : dvec3(0.2, 0.1, 0.3);
          },
          64, [](std::size_t probe, const dvec3& d) { return sees_sky(probe, d) ? kNothing : 2.0F; }};
}

double difference(const BakedProbes& a, const BakedProbes& b) {
  double square = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < a.coefficients.size(); ++k) {
    square += glm::dot(a.coefficients[k] - b.coefficients[k], a.coefficients[k] - b.coefficients[k]);
    whole += glm::dot(a.coefficients[k], a.coefficients[k]);
  }
  return std::sqrt(square / whole);
}

const ProbeOptions kOptions{.projection = {.bands = 3}, .environment_bands = 4};

}  // namespace

TEST_CASE("relight: gives what capturing again gives, of any new, turned or brighter environment", "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const std::vector<SphericalHarmonics> others{made_up(4, 2.1),
                                               turned(from, Quaternion{.w = 0.6, .x = 0.3, .y = 0.7, .z = -0.2}),
                                               scale(from, dvec3(3, 2, 0.1))};
  const Captures before = captured(from);
  const BakedProbes baked = bake_probes(kGrid, before.cubes, before.depths, kOptions);
  for (const SphericalHarmonics& to : others) {
    const Captures after = captured(to);
    const BakedProbes again = bake_probes(kGrid, after.cubes, after.depths, kOptions);
    BakedProbes relit = baked;
    relight(relit, from, to);
    CHECK(difference(again, baked) > 0.02);
    // Texels of 1/64 stand for their middles in what is captured.
    CHECK(difference(again, relit) < 3e-4);
    // And the way back.
    relight(relit, to, from);
    CHECK(difference(baked, relit) < 1e-14);
  }
}

TEST_CASE("relight: is linear, and the same on any number of threads", "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const SphericalHarmonics to = made_up(4, 1.3);
  const Captures captures = captured(from);
  const BakedProbes baked = bake_probes(kGrid, captures.cubes, captures.depths, kOptions);
  BakedProbes once = baked;
  BakedProbes twice = baked;
  relight(once, from, to);
  run_with_threads(3, [&] { relight(twice, from, add(to, add(to, scale(from, dvec3(-1.0))))); });
  for (std::size_t k = 0; k < baked.coefficients.size(); ++k) {
    const dvec3 step = once.coefficients[k] - baked.coefficients[k];
    CHECK(glm::length(twice.coefficients[k] - baked.coefficients[k] - 2.0 * step) < 1e-12);
  }
  BakedProbes alone = baked;
  run_with_threads(1, [&] { relight(alone, from, to); });
  CHECK(same_bytes<dvec3>(once.coefficients, alone.coefficients));
}

TEST_CASE("relight: a probe that sees everything has the environment itself, one in a box nothing", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}};
  const SphericalHarmonics from = made_up(2, 0.4);
  const SphericalHarmonics to = made_up(5, 5.0);
  const Captures captures(
      2, 8, [&](std::size_t, const dvec3&) { return dvec3(1.0); }, 8,
      [](std::size_t probe, const dvec3&) { return probe == 0 ? kNothing : 3.0F; });
  BakedProbes probes =
      bake_probes(grid, captures.cubes, captures.depths, {.projection = {.bands = 3}, .environment_bands = 3});
  const BakedProbes before = probes;
  CHECK(before.sky[0] == Approx(std::sqrt(4.0 * std::numbers::pi)));
  relight(probes, from, to);
  const SphericalHarmonics change = add(to, scale(from, dvec3(-1.0)));
  for (std::size_t k = 0; k < 9; ++k) {
    CHECK(glm::length(probes.coefficients[k] - before.coefficients[k] - change.coefficients()[k]) < 1e-5);
    CHECK(probes.coefficients[9 + k] == before.coefficients[9 + k]);
  }
}

TEST_CASE("relight: invalid probes get their neighbours' new light", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}};
  const Captures captures(
      2, 4, [&](std::size_t, const dvec3&) { return dvec3(1.0); }, 4,
      [](std::size_t probe, const dvec3&) { return probe == 0 ? kNothing : -3.0F; });
  BakedProbes probes = bake_probes(grid, captures.cubes, captures.depths, {.environment_bands = 1});
  CHECK(probes.invalid == 1);
  relight(probes, constant_radiance(dvec3(1.0)), constant_radiance(dvec3(4.0)));
  CHECK(probes.coefficients[9] == probes.coefficients[0]);
  CHECK(probes.coefficients[9].x == Approx(4.0 * std::sqrt(4.0 * std::numbers::pi)));
}

TEST_CASE("relight: refuses coefficients that are not finite or too large, names them, and changes nothing",
          "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const Captures captures = captured(from);
  BakedProbes probes = bake_probes(kGrid, captures.cubes, captures.depths, kOptions);
  const BakedProbes before = probes;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {nan, infinity, -infinity, 1e308, -1e101}) {
    SphericalHarmonics light = from;
    light.at(2, -1).y = wrong;
    CAPTURE(wrong);
    for (const bool is_new : {false, true}) {
      const ThrownError error = thrown_by([&] { relight(probes, is_new ? from : light, is_new ? light : from); });
      CHECK(error.code == ErrorCode::invalid_argument);
      CHECK(error.says(is_new ? "coefficient (2, -1) of `to` is " : "coefficient (2, -1) of `from` is "));
      CHECK(error.says("in green"));
      CHECK(same_bytes<dvec3>(probes.coefficients, before.coefficients));
    }
  }
  relight(probes, from, scale(from, dvec3(1e38)));
  for (const dvec3& coefficient : probes.coefficients) CHECK(std::isfinite(coefficient.x + coefficient.y));
}

TEST_CASE("relight: refuses probes that know nothing of the sky", "[probes]") {
  const Captures captures(1, 4, [&](std::size_t, const dvec3&) { return dvec3(1.0); });
  BakedProbes probes = bake_probes({}, captures.cubes);
  CHECK(thrown_by([&] { relight(probes, SphericalHarmonics(1), SphericalHarmonics(1)); }).says("environment_bands"));
}

}  // namespace welkin::test
