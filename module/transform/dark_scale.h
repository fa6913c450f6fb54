// Dark pictures are transformed at a size at which denormals are too small to matter.
//
// The transforms flush denormals to zero, and which results count as denormal differs between processors: x86 looks at
// them after they were rounded, ARM before. Beside a texel of 2^-60 that shows in no bit: the picture's mean is then at
// least 2^-85 (of 2^25 texels), and what is added to it is lost below 2^-110, long before 2^-126. A channel with
// nothing that bright is multiplied by a power of two, transformed, and divided by it again. Both are exact but where a
// result itself is denormal, and are done without flushing.
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
