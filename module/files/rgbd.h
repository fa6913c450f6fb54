// RGBD: radiance in four bytes, as Babylon.js's .env files keep it.
//
// With m = max(r, g, b): d = floor(255 / m) from 1 to 255, and a byte is the 1/2.2th power of channel x d / 255. So
// numbers up to 1 have d = 255 and are gamma-encoded colours; above, d falls, and at 255 it ends.
// (Babylon.js, ShadersInclude/helperFunctions: toRGBD, fromRGBD.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace welkin::files {

inline constexpr float kLargestRgbd = 255.0F;

/// The same bytes on every machine: the power is a table of the places where one byte gives way to the next.
class RgbdEncoder {
 public:
  RgbdEncoder();

  /// Texels of four bytes from packed RGB. Returns how many channel values were clamped to 0 .. 255 (NaN becomes 0).
  std::uint64_t encode(const float* rgb, std::size_t count, std::uint8_t* rgbd) const noexcept;

 private:
  [[nodiscard]] std::uint8_t gamma(double value) const noexcept;

  std::array<double, 255> thresholds_{};
};

/// Each rounded once to float. A d of 0, which no writer makes, is taken as 1.
class RgbdDecoder {
 public:
  RgbdDecoder();
  void decode(const std::uint8_t* rgbd, std::size_t count, float* rgb) const noexcept;

 private:
  std::array<double, 256> linear_{};
};

}  // namespace welkin::files
