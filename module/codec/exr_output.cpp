#include "codec/exr_output.h"

#include <algorithm>
#include <cmath>

#include "codec/small_floats.h"

namespace welkin::codec {

void convert_for_exr(const float* from, std::size_t count, float* to, std::uint64_t& /*clamped*/) noexcept {
  std::copy_n(from, count, to);
}

void convert_for_exr(const float* from, std::size_t count, Imath::half* to, std::uint64_t& clamped) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    float value = from[i];
    if (std::isfinite(value) && std::abs(value) > kLargestHalf) {
      value = std::copysign(kLargestHalf, value);
      ++clamped;
    }
    to[i] = Imath::half(value);
  }
}

}  // namespace welkin::codec
