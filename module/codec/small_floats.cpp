#include "codec/small_floats.h"

#include <algorithm>
#include <bit>

#include "image/formats.h"

namespace welkin::codec {
namespace {

constexpr int kFloatMantissaBits = 23;
constexpr int kFloatBias = 127;
constexpr int kSmallestExponent = -14;  // of a normal number with five bits of exponent
constexpr int kHalfMantissaBits = 10;

/// A non-negative finite value as five bits of exponent (bias 15) and `mantissa_bits` below them. Ties to even. In
/// integers, so that no rounding happens twice.
std::uint32_t small_float(float value, int mantissa_bits) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const int exponent = static_cast<int>(bits >> kFloatMantissaBits) - kFloatBias;
  if (exponent < kSmallestExponent - mantissa_bits - 1) return 0;  // less than half of the least number
  const std::uint32_t significand = (bits & 0x7FFFFFU) | 0x800000U;
  const bool denormal = exponent < kSmallestExponent;
  const int shift = kFloatMantissaBits - mantissa_bits + (denormal ? kSmallestExponent - exponent : 0);
  const std::uint32_t below_half = (1U << (shift - 1)) - 1U;
  const std::uint32_t rounded = (significand + below_half + (significand >> shift & 1U)) >> shift;
  // A normal number's leading one adds 1 to the exponent, and so does a mantissa that was rounded over its end.
  return denormal ? rounded : rounded + (static_cast<std::uint32_t>(exponent - kSmallestExponent) << mantissa_bits);
}

float from_small_float(std::uint32_t bits, int mantissa_bits) noexcept {
  return image::float_from_half(static_cast<std::uint16_t>(bits << (kHalfMantissaBits - mantissa_bits)));
}

/// 2^exponent, -126 to 127.
float power_of_two(int exponent) noexcept {
  return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + kFloatBias) << kFloatMantissaBits);
}

}  // namespace

std::uint16_t half_from_float(float value) noexcept {
  const auto sign = static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(value) >> 16U & 0x8000U);
  const auto magnitude = std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & 0x7FFFFFFFU);
  return static_cast<std::uint16_t>(sign | small_float(magnitude, kHalfMantissaBits));
}

std::uint32_t pack_b10g11r11(const std::array<float, 3>& rgb) noexcept {
  return small_float(rgb[0], 6) | small_float(rgb[1], 6) << 11U | small_float(rgb[2], 5) << 22U;
}

std::array<float, 3> unpack_b10g11r11(std::uint32_t texel) noexcept {
  return {from_small_float(texel & 0x7FFU, 6), from_small_float(texel >> 11U & 0x7FFU, 6),
          from_small_float(texel >> 22U, 5)};
}

std::uint32_t pack_e5b9g9r9(const std::array<float, 3>& rgb) noexcept {
  constexpr int bits = 9;
  constexpr int bias = 15;
  const float largest = std::max({rgb[0], rgb[1], rgb[2]});
  const int logarithm = static_cast<int>(std::bit_cast<std::uint32_t>(largest) >> kFloatMantissaBits) - kFloatBias;
  int exponent = std::max(-bias - 1, logarithm) + 1 + bias;
  const auto mantissa = [&exponent](float value) {
    // Scaling by a power of two is exact in double; so is adding a half.
    const double scaled = static_cast<double>(value) * static_cast<double>(power_of_two(bias + bits - exponent));
    return static_cast<std::uint32_t>(scaled + 0.5);
  };
  if (mantissa(largest) == 1U << bits) ++exponent;
  return mantissa(rgb[0]) | mantissa(rgb[1]) << 9U | mantissa(rgb[2]) << 18U |
         static_cast<std::uint32_t>(exponent) << 27U;
}

std::array<float, 3> unpack_e5b9g9r9(std::uint32_t texel) noexcept {
  const float scale = power_of_two(static_cast<int>(texel >> 27U) - 24);
  return {static_cast<float>(texel & 0x1FFU) * scale, static_cast<float>(texel >> 9U & 0x1FFU) * scale,
          static_cast<float>(texel >> 18U & 0x1FFU) * scale};
}

}  // namespace welkin::codec
