// Views of the caller's pixels: Welkin reads environments in place and never owns them.
#pragma once

#include <array>
#include <cstddef>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// How one texel lies in memory: interleaved channels, no padding inside a texel.
/// Alpha is read past and never used. f16 is IEEE 754 binary16; u8 maps 0..255 to 0..1;
/// srgb8 does so and then applies the sRGB transfer function (IEC 61966-2-1).
enum class PixelFormat {
  rgb_f32,
  rgba_f32,
  rgb_f16,
  rgba_f16,
  rgb_u8,
  rgba_u8,
  rgb_srgb8,
  rgba_srgb8,
};

/// Bytes that one texel takes: 3 to 16.
[[nodiscard]] constexpr std::size_t bytes_per_texel(PixelFormat format) noexcept {
  switch (format) {
    case PixelFormat::rgb_f32: return 12;
    case PixelFormat::rgba_f32: return 16;
    case PixelFormat::rgb_f16: return 6;
    case PixelFormat::rgba_f16: return 8;
    case PixelFormat::rgb_u8:
    case PixelFormat::rgb_srgb8: return 3;
    case PixelFormat::rgba_u8:
    case PixelFormat::rgba_srgb8: return 4;
  }
  return 0;
}

/// Six square faces in the order +X -X +Y -Y +Z -Z, row 0 on top.
///
/// | face | normal | u (column) runs along | v (row) runs along |
/// |---|---|---|---|
/// | +X | +x | -z | -y |
/// | -X | -x | +z | -y |
/// | +Y | +y | +x | +z |
/// | -Y | -y | +x | -z |
/// | +Z | +z | +x | -y |
/// | -Z | -z | -x | -y |
///
/// Texel (column i, row j) is a square whose centre is (u, v) = ((2i+1)/size - 1, (2j+1)/size - 1).
struct CubemapView {
  std::array<const void*, 6> faces{};         ///< first texel of each face; float formats aligned to their channel
  int size = 0;                               ///< texels along an edge, 1 to 16384; need not be even
  std::ptrdiff_t row_stride_bytes = 0;        ///< from a row to the next; 0: rows are packed; negative: bottom-up
  PixelFormat format = PixelFormat::rgb_f32;  ///< of all six faces

  /// Whether these are the same pixels in memory, not whether they hold the same values. So for `LatLongView`.
  friend bool operator==(const CubemapView&, const CubemapView&) = default;
};

/// A full sphere as latitude over longitude (equirectangular).
///
/// Texel (column i, row j) covers latitudes from pi/2 - pi j/height down to pi/2 - pi (j+1)/height and
/// longitudes from pi - 2 pi i/width to pi - 2 pi (i+1)/width, and a direction is
/// (sin(lon) cos(lat), sin(lat), cos(lon) cos(lat)): the centre looks along +z, +x lies a quarter in from
/// the left. That is OpenEXR's orientation with texels as areas.
struct LatLongView {
  const void* pixels = nullptr;               ///< first texel of the top row
  int width = 0;                              ///< 1 to 65536; twice the height as a rule, but any ratio is taken
  int height = 0;                             ///< 1 to 32768
  std::ptrdiff_t row_stride_bytes = 0;        ///< from a row to the next; 0: rows are packed; negative: bottom-up
  PixelFormat format = PixelFormat::rgb_f32;  ///< of the pixels

  friend bool operator==(const LatLongView&, const LatLongView&) = default;
};

}  // namespace welkin
