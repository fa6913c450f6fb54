// The changing source: a sky whose sun moves, computed again each time its light is needed.
#pragma once

#include <welkin/core.h>
#include <welkin/image.h>
#include <welkin/projection.h>

namespace engine_loop {

/// A cubemap of a blue gradient, dark ground and a small bright sun half-way up. `sun_angle`, in radians, turns it
/// about the vertical. Cost: 10 ns per texel, spread over the caller's arena.
[[nodiscard]] welkin::Cubemap sky_cubemap(int size, double sun_angle);

/// The light of such a sky. A request of the engine's own making: any callable over Welkin's calls is one.
struct TurningSky {
  int size = 256;
  double sun_angle = 0.0;  ///< radians

  [[nodiscard]] welkin::Projection operator()(const welkin::Control& control) const;
};

}  // namespace engine_loop
