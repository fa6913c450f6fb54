// Refuses views that no call can work on, before any work.
#pragma once

#include <cstdint>

#include "welkin/image_view.h"

namespace welkin::image {

inline constexpr int kLargestFace = 16384;
inline constexpr int kLargestLatLongWidth = 65536;
inline constexpr int kLargestLatLongHeight = 32768;

/// An argument that is not from `low` to `high`, by its name. Throws as below.
void require_range(const char* what, std::int64_t value, std::int64_t low, std::int64_t high);

/// All throw `Error` (invalid_argument) with a message that says what was found and what is allowed.
void check_face_size(int size);
void check_lat_long_size(int width, int height);
void check_view(const CubemapView& cubemap);
void check_view(const LatLongView& lat_long);

}  // namespace welkin::image
