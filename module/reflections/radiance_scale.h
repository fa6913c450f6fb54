// Radiance so large that sums over it would leave the range of floats, or so small that they would lose bits.
#pragma once

#include <optional>

#include "projection/sanitized_pixels.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

/// The power of two that a picture is to be multiplied by before it is transformed: 2^-64 where a magnitude is above
/// 1e30, 2^100 where none is above 1e-25, 1 elsewhere and of black.
[[nodiscard]] float safe_scale(const projection::SanitizedSource& source) noexcept;

/// A picture times that: exact, but for what is 1e50 times darker than the brightest.
class ScaledSource {
 public:
  /// Throws `Error` (cancelled).
  ScaledSource(const projection::SanitizedSource& source, float scale, const Control& control);

  [[nodiscard]] const projection::SanitizedSource& source() const noexcept { return *source_; }

 private:
  LatLongImage lat_long_;
  Cubemap cube_;
  std::optional<projection::SanitizedSource> source_;
};

/// What was made of such a picture over the same scale. No value rounds beyond the floats.
void undo_scale(PrefilteredSpecular& result, float scale);

}  // namespace welkin::reflections
