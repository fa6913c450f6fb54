// A room with walls that light must not pass: what a grid of probes makes of it, beside paths.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

#include "probes/room.h"
#include "support/catch.h"
#include "welkin/probes.h"

namespace welkin::test {
namespace {

struct Surface {
  dvec3 place;
  dvec3 normal;
};

/// On the floor, and on both sides of the wall between the halves.
std::vector<Surface> surfaces() {
  std::vector<Surface> all;
  for (double x = -1.9; x < 2.0; x += 0.2) {
    for (double z = -0.9; z < 1.0; z += 0.3) all.push_back({{x, 0.0, z}, {0, 1, 0}});
  }
  for (double y = 0.1; y < 2.0; y += 0.2) {
    for (double z = -0.9; z < 0.3; z += 0.3) {
      all.push_back({{0.04, y, z}, {1, 0, 0}});
      all.push_back({{-0.04, y, z}, {-1, 0, 0}});
    }
  }
  return all;
}

/// Root mean square of the difference, over that of the reference.
double error_of(const BakedProbes& probes, const std::vector<Surface>& places, const std::vector<dvec3>& wanted,
                const ProbeSampling& sampling) {
  double square = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const dvec3 found = probe_irradiance(probes, places[k].place, places[k].normal, sampling);
    square += glm::dot(found - wanted[k], found - wanted[k]);
    whole += glm::dot(wanted[k], wanted[k]);
  }
  return std::sqrt(square / whole);
}

}  // namespace

TEST_CASE("probes in a room: each weight brings the light nearer to that of paths", "[probes][slow]") {
  const Room room;
  const ProbeGrid grid = Room::grid();
  const Captures captures = room.capture(grid, 12, 4, Followed::reflected);
  const BakedProbes raw = bake_probes(grid, captures.cubes, captures.depths, {.dilation_passes = 0});
  const BakedProbes probes = bake_probes(grid, captures.cubes, captures.depths);

  // Those in the six walls, the block's and none else: the thin wall stands between probes.
  std::size_t in_stone = 0;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const dvec3 p = grid.position(k);
    const bool outside = std::abs(p.x) > 2.0 || p.y < 0.0 || p.y > 2.0 || std::abs(p.z) > 1.0;
    const bool in_block = p.x > -1.5 && p.x < -0.9 && p.y > 0.0 && p.y < 0.7 && p.z > -0.7 && p.z < -0.1;
    CAPTURE(k, p.x, p.y, p.z, probes.validity[k]);
    CHECK((probes.passes[k] != 0) == (outside || in_block));
    in_stone += outside || in_block ? 1 : 0;
  }
  CHECK(probes.invalid == in_stone);
  CHECK(probes.unfilled == 0);

  const std::vector<Surface> places = surfaces();
  std::vector<dvec3> wanted;
  for (std::size_t k = 0; k < places.size(); ++k) {
    wanted.push_back(
        room.irradiance(places[k].place, places[k].normal, 256, static_cast<std::uint32_t>(k), Followed::reflected));
  }
  const ProbeSampling plain{.visibility = false, .facing = false, .validity = false, .normal_bias = 0.0};
  const double dark = error_of(raw, places, wanted, plain);
  const double leaking = error_of(probes, places, wanted, plain);
  const double seen = error_of(probes, places, wanted, {});
  CHECK(dark > 1.3 * leaking);
  CHECK(leaking > 1.3 * seen);
  CHECK(seen < 0.3);
}

}  // namespace welkin::test
