// The caller's pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "welkin/image_view.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// A cubemap and the levels behind it. Throws `Error` (invalid_argument) for null, for a count that is none, for sizes
/// that differ, for unknown formats. Whether the pixels are sound is left to those who read them.
[[nodiscard]] std::vector<CubemapView> cubemap_views(const welkin_cubemap* mips, std::int32_t mip_count);

/// Throws likewise.
[[nodiscard]] LatLongView lat_long_view(const welkin_lat_long* lat_long);

}  // namespace welkin::c_interface
