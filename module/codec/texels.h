// How texels lie in KTX2 and DDS files, and the way from floats and back.
#pragma once

#include <cstddef>
#include <cstdint>

#include "welkin/texture_file.h"

namespace welkin::codec {

/// What is read; the first four are what is written (`TexelFormat`).
enum class TexelKind { rgba16f, rgba32f, b10g11r11, e5b9g9r9, rgba8, rgba8_srgb };

[[nodiscard]] TexelKind kind_of(TexelFormat format) noexcept;

/// "rgba16f", ..., "rgba8", "rgba8 srgb"
[[nodiscard]] const char* name(TexelKind kind) noexcept;

/// 4, 8 or 16.
[[nodiscard]] std::size_t texel_bytes(TexelKind kind) noexcept;

/// Bytes of a level of six faces; `size` up to 16384.
[[nodiscard]] std::uint64_t level_bytes(TexelKind kind, int size) noexcept;

/// Texels from packed RGB floats, alpha 1. Returns how many channel values the format could not hold: what is above its
/// largest value becomes that, NaN becomes 0, and negatives 0 in the unsigned formats. Floats are kept as they are.
std::uint64_t encode_texels(TexelFormat format, const float* rgb, std::size_t count, std::uint8_t* texels) noexcept;

/// Packed RGB floats from `count` texels at an address that is a multiple of 4. Alpha is passed over.
void decode_texels(TexelKind kind, const std::uint8_t* texels, std::size_t count, float* rgb) noexcept;

}  // namespace welkin::codec
