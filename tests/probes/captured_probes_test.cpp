// Captured probes: moving them out of walls, and relighting them by another environment.
#include <glm/geometric.hpp>

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/probes.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

/// Returns the distance to the surfaces of a closed room from `low` to `high` with walls one metre thick, seen from
/// inside it or from within a wall. It is negative where the back of a surface is hit.
float room_depth(const dvec3& from, const dvec3& direction, const dvec3& low, const dvec3& high) {
  const bool inside = glm::all(glm::greaterThan(from, low)) && glm::all(glm::lessThan(from, high));
  if (inside) return static_cast<float>(distance_to_walls(from, direction, low, high));
  // Within a wall the ray hits the room's surface or the outer surface, both from behind.
  double enter = 0.0;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (low[axis] - from[axis]) / direction[axis];
    const double b = (high[axis] - from[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  const double outer = distance_to_walls(from, direction, low - 1.0, high + 1.0);
  return static_cast<float>(-(enter < leave ? std::min(enter, outer) : outer));
}

const dvec3 kLow{0.0, 0.0, 0.0};
const dvec3 kHigh{4.0, 3.0, 5.0};

/// Captures the room, whose walls shine, from the probes at their offsets.
Captures seen_from(const ProbeGrid& grid, const std::vector<dvec3>& offsets) {
  return {grid.size(), 4, [](std::size_t, const dvec3&) { return dvec3(1.0); }, 32,
          [&](std::size_t k, const dvec3& direction) {
            const dvec3 from = grid.position(k) + (offsets.empty() ? dvec3(0.0) : offsets[k]);
            return room_depth(from, direction, kLow, kHigh);
          }};
}

/// Returns the distance to the nearest wall; negative within a wall.
double clear_of_walls(const dvec3& at) {
  return std::min({at.x - kLow.x, at.y - kLow.y, at.z - kLow.z, kHigh.x - at.x, kHigh.y - at.y, kHigh.z - at.z});
}

}  // namespace

TEST_CASE("relocation: a probe within a wall comes out by the shortest way", "[probes]") {
  // 0.2 m deep in the wall at x = 0, in the middle of it; the next probe stands free.
  const ProbeGrid grid{.counts = {2, 1, 1}, .origin = {-0.2, 1.5, 2.5}, .spacing = {1.5, 1.5, 1.5}};
  const Captures seen = seen_from(grid, {});
  const std::vector<dvec3> offsets = relocate_probes(grid, seen.depths);
  REQUIRE(offsets.size() == 2);
  const double clearance = 0.12 * 1.5;
  CHECK(offsets[0].x == Approx(0.2 + clearance).epsilon(0.002));  // the texel nearest to +x is 1.3 degrees off
  CHECK(glm::length(offsets[0]) < 1.002 * (0.2 + clearance));
  CHECK(clear_of_walls(grid.position(0) + offsets[0]) > 0.99 * clearance);
  CHECK(offsets[1] == dvec3(0.0));

  // The probe is valid where it was moved to, and invalid where it was.
  CHECK(seen.bake(grid).passes == std::vector<std::uint8_t>{1, 0});
  const Captures moved = seen_from(grid, offsets);
  BakedProbes probes = moved.bake(grid);
  CHECK(probes.passes == std::vector<std::uint8_t>{0, 0});
  CHECK(relocate_probes(grid, moved.depths, {}, offsets)[1] == dvec3(0.0));

  // The lookup measures from the captured position, which is in front of the wall, not behind it.
  probes.coefficients[0] = dvec3(10.0);
  for (std::size_t k = 1; k < 9; ++k) probes.coefficients[k] = dvec3(0.0);
  const auto light_at = [&](const BakedProbes& of) {
    return probe_irradiance(of, {0.05, 1.5, 2.5}, {1, 0, 0}, {.visibility = false, .normal_bias = 0.05}).x;
  };
  BakedProbes unmoved = probes;
  probes.offsets = offsets;
  CHECK(light_at(probes) > 1.02 * light_at(unmoved));
  unmoved.offsets.assign(2, dvec3(0.0));
  const double without = light_at(unmoved);
  unmoved.offsets.clear();
  CHECK(light_at(unmoved) == without);
  // No offset causes a read outside the arrays.
  probes.offsets[0] = dvec3(std::numeric_limits<double>::quiet_NaN(), 1e300, 0.0);
  CHECK(std::isfinite(light_at(probes)));
}

TEST_CASE("relocation: probes keep clear of walls, and within their share of a cell", "[probes]") {
  const ProbeGrid grid{.counts = {5, 4, 6}, .origin = {-0.1, 0.05, -0.2}, .spacing = {1.05, 0.95, 1.08}};
  const RelocationOptions options;
  const double clearance = options.clearance * 0.95;
  std::vector<dvec3> offsets;
  for (int call = 0; call < 4; ++call) {
    offsets = relocate_probes(grid, seen_from(grid, offsets).depths, options, offsets);
  }
  for (std::size_t k = 0; k < grid.size(); ++k) {
    INFO("probe " << k);
    CHECK(clear_of_walls(grid.position(k) + offsets[k]) > 0.95 * clearance);  // corners and edges too
    for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(offsets[k][axis]) <= 0.45 * grid.spacing[axis]);
    if (clear_of_walls(grid.position(k)) > clearance) CHECK(offsets[k] == dvec3(0.0));
    CHECK(glm::length(offsets[k]) < 3.0 * std::max(0.0, clearance - clear_of_walls(grid.position(k))) + 1e-9);
  }

  // A probe whose shortest way out is too long stays.
  const ProbeGrid deep{.counts = {1, 1, 1}, .origin = {-0.49, 1.5, 2.5}, .spacing = {1, 1, 1}};
  const Captures seen = seen_from(deep, {});
  CHECK(relocate_probes(deep, seen.depths)[0] == dvec3(0.0));
  CHECK(relocate_probes(deep, seen.depths, {.clearance = 0.0, .farthest = 0.5})[0].x == Approx(0.49).epsilon(0.01));
  // Between two walls closer than twice the clearance, a probe moves to the middle.
  const auto narrow = [](std::size_t, const dvec3& d) {
    return static_cast<float>(distance_to_walls({0.05, 0, 0}, d, {0, -9, -9}, {0.2, 9, 9}));
  };
  const Captures between(
      1, 1, [](std::size_t, const dvec3&) { return dvec3(0.0); }, 32, narrow);
  const dvec3 middle = relocate_probes(deep, between.depths, {.clearance = 0.3})[0];
  CHECK(middle.x == Approx(0.05).margin(0.01));
}

TEST_CASE("relocation: what cannot be is refused", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}};
  std::vector<float> depths(6 * 4 * 4, 1.0F);
  const std::vector<DepthView> views(2, Captures::depth_view(depths, 4));
  const auto refusal = [&](const std::vector<DepthView>& seen, const RelocationOptions& options,
                           const std::vector<dvec3>& offsets) {
    return thrown_by([&] { static_cast<void>(relocate_probes(grid, seen, options, offsets)); });
  };
  CHECK(refusal({views[0]}, {}, {}).says("depths: there are 1 for 2"));
  CHECK(refusal(views, {}, {dvec3(0.0)}).says("offsets: there are 1 for 2"));
  CHECK(refusal(views, {.clearance = 0.6}, {}).says("clearance"));
  CHECK(refusal(views, {.farthest = -0.1}, {}).says("farthest"));
  CHECK(refusal(views, {.back_share = 2.0}, {}).says("back_share"));
  depths[17] = std::numeric_limits<float>::quiet_NaN();
  const ThrownError bad = refusal(views, {}, {});
  CHECK(bad.code == ErrorCode::rejected_pixel);
  CHECK(bad.says("probe 0: a depth is NaN"));
  depths.assign(depths.size(), std::numeric_limits<float>::infinity());
  CHECK(relocate_probes(grid, views) == std::vector<dvec3>(2, dvec3(0.0)));
}

// Another environment for captured probes.

namespace {

/// Returns an environment of `bands` bands that is nowhere dark.
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

/// Returns whether a probe sees the sky through a window in front of it; walls are lit by other light.
bool sees_sky(std::size_t probe, const dvec3& d) {
  const double rotation = 0.5 * static_cast<double>(probe);
  return d.y > 0.1 && std::sin(rotation) * d.x + std::cos(rotation) * d.z > -0.6;
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
                                               rotate(from, Quaternion{.w = 0.6, .x = 0.3, .y = 0.7, .z = -0.2}),
                                               scale(from, dvec3(3, 2, 0.1))};
  const Captures before = captured(from);
  const BakedProbes baked = before.bake(kGrid, kOptions);
  for (const SphericalHarmonics& to : others) {
    const Captures after = captured(to);
    const BakedProbes again = after.bake(kGrid, kOptions);
    BakedProbes relit = baked;
    relight(relit, from, to);
    CHECK(difference(again, baked) > 0.02);
    // A captured texel, of 1/64, has the light at its centre.
    CHECK(difference(again, relit) < 3e-4);
    // Relighting back restores the light.
    relight(relit, to, from);
    CHECK(difference(baked, relit) < 1e-14);
  }
}

TEST_CASE("relight: is linear, and the same on any number of threads", "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const SphericalHarmonics to = made_up(4, 1.3);
  const Captures captures = captured(from);
  const BakedProbes baked = captures.bake(kGrid, kOptions);
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
  BakedProbes probes = captures.bake(grid, {.projection = {.bands = 3}, .environment_bands = 3});
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
  BakedProbes probes = captures.bake(grid, {.environment_bands = 1});
  CHECK(probes.invalid == 1);
  relight(probes, constant_radiance(dvec3(1.0)), constant_radiance(dvec3(4.0)));
  CHECK(probes.coefficients[9] == probes.coefficients[0]);
  CHECK(probes.coefficients[9].x == Approx(4.0 * std::sqrt(4.0 * std::numbers::pi)));
}

TEST_CASE("relight: refuses coefficients that are not finite or too large, names them, and changes nothing",
          "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const Captures captures = captured(from);
  BakedProbes probes = captures.bake(kGrid, kOptions);
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
