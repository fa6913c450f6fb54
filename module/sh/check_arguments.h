// Refuses what no call can work on, before any work.
#pragma once

#include "image/check_views.h"
#include "welkin/projection.h"

namespace welkin::sh {

using image::check_lat_long_size;
using image::check_view;
using image::kLargestFace;
using image::kLargestLatLongHeight;
using image::kLargestLatLongWidth;

/// Throws `Error` (invalid_argument) with a message that says what was found and what is allowed.
void check_options(const ProjectionOptions& options);

}  // namespace welkin::sh
