#include "image/check_views.h"

#include <cstdint>
#include <cstdlib>
#include <string>

#include "welkin/error.h"

namespace welkin::image {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

std::size_t channel_bytes(PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb_f32:
    case PixelFormat::rgba_f32: return 4;
    case PixelFormat::rgb_f16:
    case PixelFormat::rgba_f16: return 2;
    default: return 1;
  }
}

void require_pixels(const std::string& what, const void* pixels, PixelFormat format) {
  if (pixels == nullptr) refuse(what + " has no pixels: its pointer is null");
  if (reinterpret_cast<std::uintptr_t>(pixels) % channel_bytes(format) != 0) {
    refuse(what + " is not aligned to its channels, which take " + std::to_string(channel_bytes(format)) +
           " bytes each");
  }
}

void require_stride(std::ptrdiff_t stride, int width, PixelFormat format) {
  const auto row = static_cast<std::ptrdiff_t>(bytes_per_texel(format)) * width;
  if (row == 0)
    refuse("the pixel format " + std::to_string(static_cast<int>(format)) + " is not one that Welkin knows");
  if (stride == 0) return;
  if (std::abs(stride) < row) {
    refuse("row_stride_bytes is " + std::to_string(stride) + ", less than a row of " + std::to_string(row) + " bytes");
  }
  if (stride % static_cast<std::ptrdiff_t>(channel_bytes(format)) != 0) {
    refuse("row_stride_bytes is " + std::to_string(stride) + ", which leaves rows unaligned to their channels of " +
           std::to_string(channel_bytes(format)) + " bytes");
  }
}

}  // namespace

void require_range(const char* what, std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value >= low && value <= high) return;
  refuse(std::string(what) + " is " + std::to_string(value) + "; it must be from " + std::to_string(low) + " to " +
         std::to_string(high));
}

void check_face_size(int size) { require_range("the cubemap's size", size, 1, kLargestFace); }

void check_lat_long_size(int width, int height) {
  require_range("the lat-long's width", width, 1, kLargestLatLongWidth);
  require_range("the lat-long's height", height, 1, kLargestLatLongHeight);
}

void check_view(const CubemapView& cubemap) {
  check_face_size(cubemap.size);
  require_stride(cubemap.row_stride_bytes, cubemap.size, cubemap.format);
  for (std::size_t face = 0; face < cubemap.faces.size(); ++face) {
    require_pixels("face " + std::to_string(face) + " of the cubemap", cubemap.faces[face], cubemap.format);
  }
}

void check_view(const LatLongView& lat_long) {
  check_lat_long_size(lat_long.width, lat_long.height);
  require_stride(lat_long.row_stride_bytes, lat_long.width, lat_long.format);
  require_pixels("the lat-long", lat_long.pixels, lat_long.format);
}

}  // namespace welkin::image
