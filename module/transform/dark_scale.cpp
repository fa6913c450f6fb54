#include "transform/dark_scale.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace welkin::transforms {

void Brightness::look_at(const float* rgb, int count, int step) noexcept {
  for (int k = 0; k < count && !is_enough(); ++k, rgb += step) {
    for (std::size_t c = 0; c < 3; ++c) largest_[c] = std::max(largest_[c], std::abs(rgb[c]));
  }
}

DarkScale Brightness::scale() const noexcept {
  DarkScale scale;
  for (std::size_t c = 0; c < 3; ++c) {
    if (largest_[c] == 0.0F || largest_[c] >= kDark) continue;
    // ilogb is floor(log2), for denormals too: the largest becomes a number from 1 to 2.
    scale.factor[c] = std::ldexp(1.0, -std::ilogb(largest_[c]));
  }
  return scale;
}

void multiply_channels(const float* from, int count, int step, const DarkScale& scale, float* to) noexcept {
  for (int k = 0; k < count; ++k, from += step, to += step) {
    // A float times a power of two from 2^-149 to 2^149 is exact in double: only the step back to float can round,
    // where the result is denormal.
    for (std::size_t c = 0; c < 3; ++c) to[c] = static_cast<float>(static_cast<double>(from[c]) * scale.factor[c]);
  }
}

}  // namespace welkin::transforms
