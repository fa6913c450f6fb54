// What stands behind a projector.
#pragma once

#include <cstddef>

#include "sky/sky_projection.h"
#include "welkin/sky_harmonics.h"

namespace welkin {

struct SkyProjectorAccess {
  [[nodiscard]] static const sky::SkyProjection& projection(const SkyProjector& projector) noexcept;
};

namespace sky {

/// Throws `Error` (invalid_argument) unless bands^2 coefficients have room.
void check_room(std::size_t room, int bands);

}  // namespace sky
}  // namespace welkin
