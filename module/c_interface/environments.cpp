#include "c_interface/environments.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

#include "c_interface/enumeration.h"
#include "c_interface/error_status.h"
#include "c_interface/versioned_struct.h"

namespace welkin::c_interface {
namespace {

constexpr std::int32_t kMostLevels = 15;  // of 16384 texels

static_assert(WELKIN_FORMAT_RGBA_SRGB8 == static_cast<int>(PixelFormat::rgba_srgb8));
static_assert(WELKIN_FORMAT_RGB_F16 == static_cast<int>(PixelFormat::rgb_f16));
static_assert(WELKIN_FORMAT_RGB_U8 == static_cast<int>(PixelFormat::rgb_u8));

PixelFormat pixel_format(welkin_format format) { return enumerator("format", format, PixelFormat::rgba_srgb8); }

/// The most negative stride has no opposite to be compared with.
std::ptrdiff_t stride(std::int64_t row_stride_bytes) {
  if (row_stride_bytes == std::numeric_limits<std::int64_t>::min()) {
    refuse("row_stride_bytes is " + std::to_string(row_stride_bytes) + "; no picture is that large");
  }
  return row_stride_bytes;
}

CubemapView cubemap_view(const welkin_cubemap* cubemap) {
  const welkin_cubemap given = read_struct(cubemap, "mips");
  CubemapView view;
  std::copy(std::begin(given.faces), std::end(given.faces), view.faces.begin());
  if (given.size < 0 || given.size > std::numeric_limits<int>::max()) {
    refuse("the cubemap's size is " + std::to_string(given.size) + "; it must be from 1 to 16384");
  }
  view.size = static_cast<int>(given.size);
  view.row_stride_bytes = stride(given.row_stride_bytes);
  view.format = pixel_format(given.format);
  return view;
}

}  // namespace

std::vector<CubemapView> cubemap_views(const welkin_cubemap* mips, std::int32_t mip_count) {
  if (mip_count < 1 || mip_count > kMostLevels) {
    refuse("mip_count is " + std::to_string(mip_count) + "; it must be from 1 to " + std::to_string(kMostLevels));
  }
  const std::size_t step = stated_size(mips, sizeof(welkin_cubemap), alignof(welkin_cubemap), "mips");
  std::vector<CubemapView> views;
  for (std::int32_t level = 0; level < mip_count; ++level) {
    // The caller's structures may be shorter or longer than ours: the next one lies where this one ends for them.
    const auto* place = reinterpret_cast<const std::byte*>(mips) + static_cast<std::size_t>(level) * step;
    const auto* mip = reinterpret_cast<const welkin_cubemap*>(place);
    if (stated_size(mip, sizeof(welkin_cubemap), alignof(welkin_cubemap), "mips") != step) {
      refuse("mips[" + std::to_string(level) + "].struct_size differs from that of mips[0]");
    }
    views.push_back(cubemap_view(mip));
  }
  return views;
}

LatLongView lat_long_view(const welkin_lat_long* lat_long) {
  const welkin_lat_long given = read_struct(lat_long, "lat_long");
  return {given.pixels, given.width, given.height, stride(given.row_stride_bytes), pixel_format(given.format)};
}

}  // namespace welkin::c_interface
