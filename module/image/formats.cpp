#include "image/formats.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace welkin::image {
namespace {

/// x^(1/5) for x in (0, 1], by Newton from a guess that divides the exponent by five. libm's pow would give
/// other last bits on other machines.
double fifth_root(double x) noexcept {
  // The bits of a double are close to its logarithm; 4/5 of the bits of 1.0 puts the exponent's bias back.
  constexpr auto bits_of_one = std::bit_cast<std::uint64_t>(1.0);
  auto root = std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) / 5 + bits_of_one / 5 * 4);
  for (int step = 0; step < 5; ++step) {  // from 6 % off, quadratically: 1e-2, 2e-4, 1e-7, 1e-14, rounding
    const double squared = root * root;
    root -= 0.2 * (root - x / (squared * squared));
  }
  return root;
}

using EightBitTable = std::array<float, 256>;

template <class Curve>
EightBitTable make_table(const Curve& curve) {
  EightBitTable table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(curve(static_cast<double>(i) / 255.0));
  return table;
}

void decode_eight_bit(const EightBitTable& table, const void* texels, int channels, int count, float* rgb) noexcept {
  const auto* from = static_cast<const std::uint8_t*>(texels);
  for (int i = 0; i < count; ++i, from += channels, rgb += 3) {
    for (int c = 0; c < 3; ++c) rgb[c] = table[from[c]];
  }
}

void decode_half(const void* texels, int channels, int count, float* rgb) noexcept {
  const auto* from = static_cast<const std::uint16_t*>(texels);
  for (int i = 0; i < count; ++i, from += channels, rgb += 3) {
    for (int c = 0; c < 3; ++c) rgb[c] = float_from_half(from[c]);
  }
}

}  // namespace

float float_from_half(std::uint16_t half) noexcept {
  // Exponent and mantissa in a float's places are the value times 2^-112, denormals too; multiplying by a
  // power of two is exact.
  const std::uint32_t magnitude = half & 0x7FFFU;
  const std::uint32_t sign = (half & 0x8000U) << 16U;
  if (magnitude >= 0x7C00U) return std::bit_cast<float>(sign | 0x7F800000U | (magnitude << 13U));
  const float scaled = std::bit_cast<float>(magnitude << 13U) * 0x1p112F;
  return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(scaled));
}

double linear_from_srgb(double encoded) noexcept {
  if (encoded <= 0.04045) return encoded / 12.92;
  const double t = (encoded + 0.055) / 1.055;  // t^2.4 = t^2 (t^(1/5))^2
  const double root = fifth_root(t);
  return t * t * (root * root);
}

double power_2_2(double value) noexcept {
  if (value <= 0.0) return 0.0;
  return value * value * fifth_root(value);
}

void decode_texels(PixelFormat format, const void* texels, int count, float* rgb) noexcept {
  static const EightBitTable linear = make_table([](double value) { return value; });
  static const EightBitTable srgb = make_table(linear_from_srgb);
  switch (format) {
    case PixelFormat::rgb_f32: std::memcpy(rgb, texels, static_cast<std::size_t>(count) * 3 * sizeof(float)); return;
    case PixelFormat::rgba_f32: {
      const auto* from = static_cast<const float*>(texels);
      for (int i = 0; i < count; ++i, from += 4, rgb += 3) std::memcpy(rgb, from, 3 * sizeof(float));
      return;
    }
    case PixelFormat::rgb_f16: return decode_half(texels, 3, count, rgb);
    case PixelFormat::rgba_f16: return decode_half(texels, 4, count, rgb);
    case PixelFormat::rgb_u8: return decode_eight_bit(linear, texels, 3, count, rgb);
    case PixelFormat::rgba_u8: return decode_eight_bit(linear, texels, 4, count, rgb);
    case PixelFormat::rgb_srgb8: return decode_eight_bit(srgb, texels, 3, count, rgb);
    case PixelFormat::rgba_srgb8: return decode_eight_bit(srgb, texels, 4, count, rgb);
  }
}

}  // namespace welkin::image
