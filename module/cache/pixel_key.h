// What passes over the pixels have in common.
#pragma once

#include "welkin/content_hash.h"

namespace welkin::cache {

/// Of clamp, gamma and policies alone.
[[nodiscard]] ContentHash pixel_key(const ProjectionOptions& options);

}  // namespace welkin::cache
