// From any pixel format to RGB floats.
#pragma once

#include <cstdint>

#include "welkin/image_view.h"

namespace welkin::image {

/// Decodes `count` texels at `texels` to packed RGB floats. Exact for float and half formats; 8-bit ones
/// are value / 255, through the sRGB transfer function where the format says so, rounded once to float.
void decode_texels(PixelFormat format, const void* texels, int count, float* rgb) noexcept;

/// A binary16 as a float, exactly; infinities and NaNs stay what they are.
[[nodiscard]] float float_from_half(std::uint16_t half) noexcept;

/// The sRGB transfer function's inverse (IEC 61966-2-1) for an encoded value in [0, 1]; error below 1e-15.
[[nodiscard]] double linear_from_srgb(double encoded) noexcept;

/// `value` raised to 2.2, for values in [0, 1]; relative error below 1e-15, the same bits everywhere.
[[nodiscard]] double power_2_2(double value) noexcept;

}  // namespace welkin::image
