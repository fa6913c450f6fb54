// How texels lie in KTX2 and DDS files, and the way from floats and back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "welkin/texture_file.h"

namespace welkin::files {

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

// Floats of few bits, as graphics APIs define them, each rounded to the nearest value that there is.

inline constexpr float kLargestHalf = 65504.0F;
inline constexpr float kLargestFloat11 = 65024.0F;      ///< 6 bits of mantissa
inline constexpr float kLargestFloat10 = 64512.0F;      ///< 5 bits of mantissa
inline constexpr float kLargestSharedFloat = 65408.0F;  ///< 511/512 x 2^16

/// IEEE 754 binary16, ties to even. `value`: finite, magnitude at most `kLargestHalf`.
[[nodiscard]] std::uint16_t half_from_float(float value) noexcept;

/// VK_FORMAT_B10G11R11_UFLOAT_PACK32: red in bits 0 to 10, green 11 to 21, blue 22 to 31, ties to even.
/// Finite values from 0 to the largest of each.
[[nodiscard]] std::uint32_t pack_b10g11r11(const std::array<float, 3>& rgb) noexcept;
[[nodiscard]] std::array<float, 3> unpack_b10g11r11(std::uint32_t texel) noexcept;

/// VK_FORMAT_E5B9G9R9_UFLOAT_PACK32: mantissas of red in bits 0 to 8, green 9 to 17, blue 18 to 26, one exponent in 27
/// to 31; a value is mantissa x 2^(exponent - 24). By the formulas of the Vulkan specification ("RGB to shared exponent
/// conversion"): halves are rounded up. Finite values from 0 to `kLargestSharedFloat`.
[[nodiscard]] std::uint32_t pack_e5b9g9r9(const std::array<float, 3>& rgb) noexcept;
[[nodiscard]] std::array<float, 3> unpack_e5b9g9r9(std::uint32_t texel) noexcept;

}  // namespace welkin::files
