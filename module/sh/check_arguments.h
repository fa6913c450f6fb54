// Refuses what no call can work on, before any work.
#pragma once

#include "welkin/image_view.h"
#include "welkin/projection.h"

namespace welkin::sh {

inline constexpr int kLargestFace = 16384;
inline constexpr int kLargestLatLongWidth = 65536;
inline constexpr int kLargestLatLongHeight = 32768;

/// All throw `Error` (invalid_argument) with a message that says what was found and what is allowed.
void check_options(const ProjectionOptions& options);
void check_lat_long_size(int width, int height);
void check_view(const CubemapView& cubemap);
void check_view(const LatLongView& lat_long);

}  // namespace welkin::sh
