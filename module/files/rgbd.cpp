#include "files/rgbd.h"

#include <algorithm>

#include "image/pixels.h"

namespace welkin::files {
namespace {

float bounded(float value, std::uint64_t& clamped) noexcept {
  if (value >= 0.0F && value <= kLargestRgbd) return value;
  ++clamped;
  return value > kLargestRgbd ? kLargestRgbd : 0.0F;
}

}  // namespace

RgbdEncoder::RgbdEncoder() {
  for (std::size_t code = 0; code < thresholds_.size(); ++code) {
    thresholds_[code] = image::power_2_2((static_cast<double>(code) + 0.5) / 255.0);
  }
}

std::uint8_t RgbdEncoder::gamma(double value) const noexcept {
  return static_cast<std::uint8_t>(std::upper_bound(thresholds_.begin(), thresholds_.end(), value) -
                                   thresholds_.begin());
}

std::uint64_t RgbdEncoder::encode(const float* rgb, std::size_t count, std::uint8_t* rgbd) const noexcept {
  std::uint64_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i, rgb += 3, rgbd += 4) {
    std::array<double, 3> texel{};
    for (std::size_t c = 0; c < 3; ++c) texel[c] = static_cast<double>(bounded(rgb[c], clamped));
    const double largest = std::max({texel[0], texel[1], texel[2], 1e-7});
    const int divisor = largest <= 1.0 ? 255 : static_cast<int>(255.0 / largest);
    for (std::size_t c = 0; c < 3; ++c) rgbd[c] = gamma(texel[c] * (divisor / 255.0));
    rgbd[3] = static_cast<std::uint8_t>(divisor);
  }
  return clamped;
}

RgbdDecoder::RgbdDecoder() {
  for (std::size_t code = 0; code < linear_.size(); ++code) {
    linear_[code] = image::power_2_2(static_cast<double>(code) / 255.0);
  }
}

void RgbdDecoder::decode(const std::uint8_t* rgbd, std::size_t count, float* rgb) const noexcept {
  for (std::size_t i = 0; i < count; ++i, rgb += 3, rgbd += 4) {
    const double scale = 255.0 / std::max<int>(rgbd[3], 1);
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<float>(linear_[rgbd[c]] * scale);
  }
}

}  // namespace welkin::files
