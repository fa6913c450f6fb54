// Projections while the caller waits.
#include "c/c_environments.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

#include "c/c_projection.h"
#include "c/c_support.h"
#include "welkin/projection.h"
#include "welkin/welkin.h"

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

namespace {

static_assert(WELKIN_MAXIMUM_BANDS == kMaximumBands);
static_assert(WELKIN_QUADRATURE_MIDPOINT == static_cast<int>(Quadrature::midpoint));
static_assert(WELKIN_NON_FINITE_REJECT == static_cast<int>(NonFinitePolicy::reject));
static_assert(WELKIN_NEGATIVE_REPLACE == static_cast<int>(NegativePolicy::replace));
static_assert(WELKIN_NEGATIVE_REJECT == static_cast<int>(NegativePolicy::reject));

}  // namespace

ProjectionOptions projection_options(const welkin_projection_options* options) {
  const auto given = read_options(options, "options");
  ProjectionOptions wanted;
  if (given.bands != 0) wanted.bands = given.bands;
  wanted.quadrature = enumerator("quadrature", given.quadrature, Quadrature::midpoint);
  wanted.target_size = given.target_size;
  const bool preserve_colour = flag("clamp_preserve_colour", given.clamp_preserve_colour);
  if (given.clamp_maximum != 0.0F) wanted.clamp = RadianceClamp{given.clamp_maximum, preserve_colour};
  wanted.gamma = flag("gamma", given.gamma);
  wanted.nan = enumerator("nan", given.nan, NonFinitePolicy::reject);
  wanted.infinity = enumerator("infinity", given.infinity, NonFinitePolicy::reject);
  wanted.negative = enumerator("negative", given.negative, NegativePolicy::reject);
  return wanted;
}

}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace): entries have no namespace to be in

welkin_status welkin_project_cubemap(const welkin_cubemap* mips, int32_t mip_count,
                                     const welkin_projection_options* options, const welkin_control* control,
                                     welkin_projection* projection) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project(cubemap_views(mips, mip_count), wanted, control_of(control)));
    return WELKIN_OK;
  });
}

welkin_status welkin_project_lat_long(const welkin_lat_long* lat_long, const welkin_projection_options* options,
                                      const welkin_control* control, welkin_projection* projection) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project(lat_long_view(lat_long), wanted, control_of(control)));
    return WELKIN_OK;
  });
}
