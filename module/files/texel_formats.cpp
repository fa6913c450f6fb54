#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "files/textures.h"
#include "image/pixels.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

/// NaN is between no bounds.
float bounded(float value, float lowest, float largest, std::uint64_t& clamped) noexcept {
  if (value >= lowest && value <= largest) return value;
  ++clamped;
  return value > largest ? largest : value < lowest ? lowest : 0.0F;
}

std::uint64_t encode_halves(const float* rgb, std::size_t count, std::uint8_t* texels) noexcept {
  constexpr std::uint16_t one = 0x3C00;
  std::uint64_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i, rgb += 3, texels += 8) {
    std::array<std::uint16_t, 4> texel{0, 0, 0, one};
    for (std::size_t c = 0; c < 3; ++c) {
      texel[c] = half_from_float(bounded(rgb[c], -kLargestHalf, kLargestHalf, clamped));
    }
    std::memcpy(texels, texel.data(), sizeof texel);
  }
  return clamped;
}

void encode_floats(const float* rgb, std::size_t count, std::uint8_t* texels) noexcept {
  for (std::size_t i = 0; i < count; ++i, rgb += 3, texels += 16) {
    const std::array<float, 4> texel{rgb[0], rgb[1], rgb[2], 1.0F};
    std::memcpy(texels, texel.data(), sizeof texel);
  }
}

template <typename Pack>
std::uint64_t encode_packed(const float* rgb, std::size_t count, std::uint8_t* texels,
                            const std::array<float, 3>& largest, const Pack& pack) noexcept {
  std::uint64_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i, rgb += 3, texels += 4) {
    std::array<float, 3> texel{};
    for (std::size_t c = 0; c < 3; ++c) texel[c] = bounded(rgb[c] + 0.0F, 0.0F, largest[c], clamped);  // -0 is 0
    const std::uint32_t packed = pack(texel);
    std::memcpy(texels, &packed, sizeof packed);
  }
  return clamped;
}

template <typename Unpack>
void decode_packed(const std::uint8_t* texels, std::size_t count, float* rgb, const Unpack& unpack) noexcept {
  for (std::size_t i = 0; i < count; ++i, rgb += 3, texels += 4) {
    const std::array<float, 3> texel = unpack(platform::read_little_endian<std::uint32_t>(texels));
    std::memcpy(rgb, texel.data(), sizeof texel);
  }
}

}  // namespace

TexelKind kind_of(TexelFormat format) noexcept {
  switch (format) {
    case TexelFormat::rgba16f: return TexelKind::rgba16f;
    case TexelFormat::rgba32f: return TexelKind::rgba32f;
    case TexelFormat::b10g11r11: return TexelKind::b10g11r11;
    case TexelFormat::e5b9g9r9: return TexelKind::e5b9g9r9;
  }
  return TexelKind::rgba16f;
}

const char* name(TexelKind kind) noexcept {
  switch (kind) {
    case TexelKind::rgba16f: return "rgba16f";
    case TexelKind::rgba32f: return "rgba32f";
    case TexelKind::b10g11r11: return "b10g11r11";
    case TexelKind::e5b9g9r9: return "e5b9g9r9";
    case TexelKind::rgba8: return "rgba8";
    case TexelKind::rgba8_srgb: return "rgba8 srgb";
  }
  return "unknown";
}

std::size_t texel_bytes(TexelKind kind) noexcept {
  if (kind == TexelKind::rgba16f) return 8;
  return kind == TexelKind::rgba32f ? 16 : 4;
}

std::uint64_t level_bytes(TexelKind kind, int size) noexcept {
  const auto edge = static_cast<std::uint64_t>(size);
  return 6 * edge * edge * texel_bytes(kind);
}

std::uint64_t encode_texels(TexelFormat format, const float* rgb, std::size_t count, std::uint8_t* texels) noexcept {
  switch (format) {
    case TexelFormat::rgba16f: return encode_halves(rgb, count, texels);
    case TexelFormat::rgba32f: encode_floats(rgb, count, texels); return 0;
    case TexelFormat::b10g11r11:
      return encode_packed(rgb, count, texels, {kLargestFloat11, kLargestFloat11, kLargestFloat10}, pack_b10g11r11);
    case TexelFormat::e5b9g9r9:
      return encode_packed(rgb, count, texels, {kLargestSharedFloat, kLargestSharedFloat, kLargestSharedFloat},
                           pack_e5b9g9r9);
  }
  return 0;
}

void decode_texels(TexelKind kind, const std::uint8_t* texels, std::size_t count, float* rgb) noexcept {
  const auto whole = static_cast<int>(count);
  switch (kind) {
    case TexelKind::rgba16f: return image::decode_texels(PixelFormat::rgba_f16, texels, whole, rgb);
    case TexelKind::rgba32f: return image::decode_texels(PixelFormat::rgba_f32, texels, whole, rgb);
    case TexelKind::rgba8: return image::decode_texels(PixelFormat::rgba_u8, texels, whole, rgb);
    case TexelKind::rgba8_srgb: return image::decode_texels(PixelFormat::rgba_srgb8, texels, whole, rgb);
    case TexelKind::b10g11r11: return decode_packed(texels, count, rgb, unpack_b10g11r11);
    case TexelKind::e5b9g9r9: return decode_packed(texels, count, rgb, unpack_e5b9g9r9);
  }
}

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

}  // namespace welkin::files
