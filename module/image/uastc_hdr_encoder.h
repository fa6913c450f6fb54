// UASTC HDR of pictures, the faces of cubemaps among them.
#pragma once

#include <span>
#include <vector>

#include "image/block_pictures.h"

namespace welkin::image {

/// Encodes the pictures of each level in blocks of `uastc_hdr.h`. Throws as `encode_pictures`.
[[nodiscard]] EncodedLevels encode_uastc_hdr_pictures(std::span<const std::vector<LatLongView>> levels,
                                                      Bc6hEffort effort, const Control& control);

}  // namespace welkin::image
