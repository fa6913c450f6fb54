// Probes that are moved out of walls.
#include <glm/geometric.hpp>

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/probes.h"

namespace welkin::test {
namespace {

/// A closed room from `low` to `high` with walls a metre thick, seen from inside it or from within a wall: the
/// distance, negative where the back of a surface is met.
float room_depth(const dvec3& from, const dvec3& direction, const dvec3& low, const dvec3& high) {
  const bool inside = glm::all(glm::greaterThan(from, low)) && glm::all(glm::lessThan(from, high));
  if (inside) return static_cast<float>(distance_to_walls(from, direction, low, high));
  // Within a wall: to the room's surface, from behind, or to the outer surface, likewise.
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

/// Depths of all probes at their offsets.
struct Seen {
  Seen(const ProbeGrid& grid, const std::vector<dvec3>& offsets, int size = 32) {
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const dvec3 from = grid.position(k) + (offsets.empty() ? dvec3(0.0) : offsets[k]);
      distances.emplace_back();
      Captures::for_each_texel(
          size, [&](const dvec3& direction) { distances.back().push_back(room_depth(from, direction, kLow, kHigh)); });
    }
    for (const std::vector<float>& each : distances) views.push_back(Captures::depth_view(each, size));
  }
  Seen(const Seen&) = delete;
  Seen& operator=(const Seen&) = delete;

  std::vector<std::vector<float>> distances;
  std::vector<DepthView> views;
};

/// To the nearest wall; negative within one.
double clear_of_walls(const dvec3& at) {
  return std::min({at.x - kLow.x, at.y - kLow.y, at.z - kLow.z, kHigh.x - at.x, kHigh.y - at.y, kHigh.z - at.z});
}

}  // namespace

TEST_CASE("relocation: a probe within a wall comes out by the shortest way", "[probes]") {
  // 0.2 m deep in the wall at x = 0, in the middle of it; the next probe stands free.
  const ProbeGrid grid{.counts = {2, 1, 1}, .origin = {-0.2, 1.5, 2.5}, .spacing = {1.5, 1.5, 1.5}};
  const Seen seen(grid, {});
  const std::vector<dvec3> offsets = relocate_probes(grid, seen.views);
  REQUIRE(offsets.size() == 2);
  const double clearance = 0.12 * 1.5;
  CHECK(offsets[0].x == Approx(0.2 + clearance).epsilon(0.002));  // the texel nearest to +x is 1.3 degrees off
  CHECK(glm::length(offsets[0]) < 1.002 * (0.2 + clearance));
  CHECK(clear_of_walls(grid.position(0) + offsets[0]) > 0.99 * clearance);
  CHECK(offsets[1] == dvec3(0.0));

  // Baked where it was moved to it is valid, and where it was it is not.
  const auto light = [](std::size_t, const dvec3&) { return dvec3(1.0); };
  const Captures captures(2, 4, light);
  CHECK(bake_probes(grid, captures.cubes, seen.views).passes == std::vector<std::uint8_t>{1, 0});
  const Seen moved(grid, offsets);
  BakedProbes probes = bake_probes(grid, captures.cubes, moved.views);
  CHECK(probes.passes == std::vector<std::uint8_t>{0, 0});
  CHECK(relocate_probes(grid, moved.views, {}, offsets)[1] == dvec3(0.0));

  // The lookup measures from where the probe was captured: it is in front of the wall then, not behind.
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
  // No number leads out of the arrays.
  probes.offsets[0] = dvec3(std::numeric_limits<double>::quiet_NaN(), 1e300, 0.0);
  CHECK(std::isfinite(light_at(probes)));
}

TEST_CASE("relocation: probes keep clear of walls, and within their share of a cell", "[probes]") {
  const ProbeGrid grid{.counts = {5, 4, 6}, .origin = {-0.1, 0.05, -0.2}, .spacing = {1.05, 0.95, 1.08}};
  const RelocationOptions options;
  const double clearance = options.clearance * 0.95;
  std::vector<dvec3> offsets;
  for (int call = 0; call < 4; ++call) {
    const Seen seen(grid, offsets);
    offsets = relocate_probes(grid, seen.views, options, offsets);
  }
  for (std::size_t k = 0; k < grid.size(); ++k) {
    INFO("probe " << k);
    CHECK(clear_of_walls(grid.position(k) + offsets[k]) > 0.95 * clearance);  // corners and edges too
    for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(offsets[k][axis]) <= 0.45 * grid.spacing[axis]);
    if (clear_of_walls(grid.position(k)) > clearance) CHECK(offsets[k] == dvec3(0.0));
    CHECK(glm::length(offsets[k]) < 3.0 * std::max(0.0, clearance - clear_of_walls(grid.position(k))) + 1e-9);
  }

  // Who has no way out that is short enough stays.
  const ProbeGrid deep{.counts = {1, 1, 1}, .origin = {-0.49, 1.5, 2.5}, .spacing = {1, 1, 1}};
  const Seen seen(deep, {});
  CHECK(relocate_probes(deep, seen.views)[0] == dvec3(0.0));
  CHECK(relocate_probes(deep, seen.views, {.clearance = 0.0, .farthest = 0.5})[0].x == Approx(0.49).epsilon(0.01));
  // Between two walls closer than twice the clearance: the middle.
  const std::vector<float> narrow = [] {
    std::vector<float> depths;
    Captures::for_each_texel(32, [&](const dvec3& d) {
      depths.push_back(static_cast<float>(distance_to_walls({0.05, 0, 0}, d, {0, -9, -9}, {0.2, 9, 9})));
    });
    return depths;
  }();
  const DepthView view = Captures::depth_view(narrow, 32);
  const dvec3 middle = relocate_probes(deep, {&view, 1}, {.clearance = 0.3})[0];
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

}  // namespace welkin::test
