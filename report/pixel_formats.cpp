#include "report/pixel_formats.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/gtc/packing.hpp>

namespace welkin::report {
namespace {

/// IEC 61966-2-1.
float encode_srgb(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

/// Appends a channel as `Stored`.
template <typename Stored>
void append(std::vector<std::byte>& bytes, Stored value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void append(std::vector<std::byte>& bytes, float value, PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb_f32:
    case PixelFormat::rgba_f32: append(bytes, value); return;
    case PixelFormat::rgb_f16:
    case PixelFormat::rgba_f16: append<std::uint16_t>(bytes, glm::packHalf1x16(std::min(value, 65504.0F))); return;
    case PixelFormat::rgb_u8:
    case PixelFormat::rgba_u8: break;
    case PixelFormat::rgb_srgb8:
    case PixelFormat::rgba_srgb8: value = encode_srgb(std::clamp(value, 0.0F, 1.0F)); break;
  }
  append(bytes, static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))));
}

bool has_alpha(PixelFormat format) {
  return format == PixelFormat::rgba_f32 || format == PixelFormat::rgba_f16 || format == PixelFormat::rgba_u8 ||
         format == PixelFormat::rgba_srgb8;
}

}  // namespace

std::string name(PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb_f32: return "rgb32f";
    case PixelFormat::rgba_f32: return "rgba32f";
    case PixelFormat::rgb_f16: return "rgb16f";
    case PixelFormat::rgba_f16: return "rgba16f";
    case PixelFormat::rgb_u8: return "rgb8";
    case PixelFormat::rgba_u8: return "rgba8";
    case PixelFormat::rgb_srgb8: return "rgb8srgb";
    case PixelFormat::rgba_srgb8: return "rgba8srgb";
  }
  return "unknown";
}

FormattedCubemap::FormattedCubemap(const CubemapImage& image, PixelFormat format) : size_(image.size), format_(format) {
  bytes_.reserve(image.pixels.size() / 3 * bytes_per_texel(format));
  for (std::size_t k = 0; k < image.pixels.size(); ++k) {
    append(bytes_, image.pixels[k], format);
    if (k % 3 == 2 && has_alpha(format)) append(bytes_, 1.0F, format);
  }
}

CubemapView FormattedCubemap::view() const noexcept {
  CubemapView view{{}, size_, 0, format_};
  const std::size_t face = bytes_.size() / 6;
  for (std::size_t k = 0; k < 6; ++k) view.faces[k] = bytes_.data() + k * face;
  return view;
}

}  // namespace welkin::report
