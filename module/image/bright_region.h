// A bright spot of a map and the ring of texels around it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "image/texel_grid.h"

namespace welkin::image {

struct BrightRegion {
  std::vector<std::int64_t> spot;  ///< its texels, rising
  std::vector<std::int64_t> rim;   ///< finite texels that touch the spot, rising: its edge may cover a part of them
  std::vector<std::int64_t> ring;  ///< finite texels within two more steps, rising
};

/// All finite texels that are at least as bright as `least_luminance` and joined to `seed` by such texels. None if they
/// are no spot of this radius (0 to 90 degrees): if one of them is farther than that from the mean of their directions,
/// weighted by luminance, and no neighbour of the seed. Gives up as soon as one is farther than twice the radius from
/// the seed. Takes a bit a texel of the map, and time in proportion to the spot's texels.
[[nodiscard]] std::optional<BrightRegion> find_bright_region(const TexelGrid& grid, const float* pixels,
                                                             std::int64_t seed, double least_luminance,
                                                             double maximum_radius_degrees);

/// The median of the ring's texels, channel by channel (of an even number the lower one of the middle two), not below
/// zero. The ring must not be empty.
[[nodiscard]] glm::vec3 radiance_around(const BrightRegion& region, const float* pixels);

}  // namespace welkin::image
