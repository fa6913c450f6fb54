// A Cornell-like room, a small path tracer for it, and captures of a grid of probes in it. Results are equal on
// every machine except the last bits of a square root's sums: random numbers are hashes of their purpose.
#pragma once

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin::test {

/// x from -2 to 2, y from 0 to 2, z from -1 to 1. A red wall on the left, a green one on the right, the others white. A
/// light in the ceiling of the left half; a thin wall at x = 0 keeps it from the right half, except for a door at the
/// front, z > 0.35. A block stands in the left half. Walls are one metre thick, which a probe in a wall sees.
class Room {
 public:
  struct Hit {
    double distance;  ///< infinite: nothing
    dvec3 position;
    dvec3 normal;  ///< towards the origin of the ray
    dvec3 albedo;
    bool is_light;
    bool is_back;
  };

  Room();

  [[nodiscard]] Hit trace(const dvec3& from, const dvec3& direction) const;

  /// Returns the radiance that surfaces reflect back along a ray; the light itself is not seen.
  [[nodiscard]] dvec3 radiance(const dvec3& from, const dvec3& direction, std::uint32_t seed) const;

  /// Returns the irradiance of the same light on a surface, from `paths` paths.
  [[nodiscard]] dvec3 irradiance(const dvec3& position, const dvec3& normal, int paths, std::uint32_t seed) const;

  /// Returns cubemaps and depths of all probes of a grid; each texel has `paths` paths through its centre, black if 0.
  [[nodiscard]] Captures capture(const ProbeGrid& grid, int size, int paths) const;

  /// 6 x 6 x 6 probes whose outermost ones stand in the walls.
  [[nodiscard]] static ProbeGrid grid() {
    return {.counts = {6, 6, 6}, .origin = {-2.1, -0.1, -1.1}, .spacing = {0.84, 0.44, 0.44}};
  }

 private:
  /// A box of stone; the colours of the room's red and green walls by `albedo`.
  struct Box {
    dvec3 low;
    dvec3 high;
    dvec3 albedo;
  };

  [[nodiscard]] dvec3 direct(const dvec3& position, const dvec3& normal, std::uint32_t& state) const;
  [[nodiscard]] bool free_between(const dvec3& from, const dvec3& to) const;

  std::vector<Box> boxes_;
};

}  // namespace welkin::test
