// Dark images are scaled before a transform, so that denormals are too small to matter.
//
// The transforms flush denormals to zero, and which results count as denormal differs between processors: x86 checks
// after rounding, ARM before. In an image with a texel of 2^-60 or more this changes no bit: its mean is at least 2^-85
// (of 2^25 texels), and terms below 2^-110, far above 2^-126, no longer change it. A channel without such a texel is
// multiplied by a power of two, transformed, and divided again. Both are exact unless a result itself is denormal, and
// are done without flushing.
#pragma once

#include <array>

#include "welkin/image.h"

namespace welkin::transforms {

/// A power of two for each channel; 1 where a channel is bright enough, or black.
struct DarkScale {
  std::array<double, 3> factor{1.0, 1.0, 1.0};

  [[nodiscard]] bool is_one() const noexcept { return factor[0] == 1.0 && factor[1] == 1.0 && factor[2] == 1.0; }
  [[nodiscard]] DarkScale inverse() const noexcept { return {{1.0 / factor[0], 1.0 / factor[1], 1.0 / factor[2]}}; }
};

/// Below this, in magnitude, a channel is dark.
inline constexpr float kDark = 0x1p-60F;

/// The largest magnitudes of three channels that have been met.
class Brightness {
 public:
  /// Looks at RGB values, `step` floats from one to the next, until no channel is dark any more.
  void look_at(const float* rgb, int count, int step) noexcept;
  [[nodiscard]] bool is_enough() const noexcept {
    return largest_[0] >= kDark && largest_[1] >= kDark && largest_[2] >= kDark;
  }
  /// Brings the largest of each dark channel to 1 or a little above.
  [[nodiscard]] DarkScale scale() const noexcept;

 private:
  std::array<float, 3> largest_{};
};

/// rgb[step k + c] times the channel's factor, each rounded once, for k < count.
void multiply_channels(const float* from, int count, int step, const DarkScale& scale, float* to) noexcept;

}  // namespace welkin::transforms
