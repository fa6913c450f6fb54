// A small sky that needs no file: gradient, sun and ground.
#pragma once

#include "welkin/image.h"

namespace welkin {

/// A clear day as an example and as the command's default input: a blue gradient that pales towards the
/// horizon, a warm sun 40 degrees up towards +z and a little to +x, dark ground. Not physics, but the same
/// bits on every machine. `height` >= 1 (width is twice that), else `Error` (invalid_argument).
[[nodiscard]] LatLongImage analytic_sky(int height = 512);

}  // namespace welkin
