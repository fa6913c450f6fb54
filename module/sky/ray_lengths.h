// Density-weighted lengths along the rays of a table: no wavelength changes them, no ground, and no amount of haze.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "welkin/core.h"

namespace welkin::sky {

struct RayLengths {
  std::vector<PerConstituent> amounts;  ///< `lengths_along` each ray

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof *this +
           amounts.size() * (sizeof(PerConstituent) + sizeof(Ray));  // the rays are kept too, to be compared
  }
};

/// Those of the last few tables are kept: a sky that only changes its ground or how much of its haze there is computes
/// them once. Throws `Error` (cancelled).
[[nodiscard]] std::shared_ptr<const RayLengths> lengths_of(const AirModel& air, std::vector<Ray> rays,
                                                           const Control& control);

}  // namespace welkin::sky
