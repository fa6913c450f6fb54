#include "codec/texels.h"

#include <array>
#include <cstring>

#include "codec/little_endian.h"
#include "codec/small_floats.h"
#include "image/formats.h"

namespace welkin::codec {
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
    const std::array<float, 3> texel = unpack(read_little_endian<std::uint32_t>(texels));
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

}  // namespace welkin::codec
