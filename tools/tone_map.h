// Light to what a screen can show.
#pragma once

#include <glm/vec3.hpp>

#include "welkin/image_view.h"

namespace welkin::tool {

/// An exposure and a curve. The result is linear, in [0, 1]; the sRGB curve comes when it is written.
struct ToneMap {
  double exposure = 1.0;  ///< radiance is multiplied by it first

  /// Narkowicz's fit of the ACES curve (2015), without its 0.6: x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14).
  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& radiance) const noexcept;
};

/// What puts the environment's mean luminance at 0.18, middle grey. The mean leaves out what is four times brighter
/// than itself, so that a sun does not leave the rest in the dark. 1 if there is no light. `level` is packed rgb_f32; a
/// small one will do.
[[nodiscard]] ToneMap tone_map_of(const CubemapView& level);

}  // namespace welkin::tool
