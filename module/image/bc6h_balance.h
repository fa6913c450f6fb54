// The light of a level in BC6H: the ends of its brightest blocks are changed to keep its mean (block_light.h).
#pragma once

#include <cstddef>
#include <vector>

#include "image/bc6h.h"
#include "image/bc6h_kernels.h"
#include "image/block_pictures.h"
#include "welkin/image.h"

namespace welkin::image {

/// A lane's block with two lines.
[[nodiscard]] Bc6hFields fields_of(const TwoLineBlocks& pair, std::size_t lane) noexcept;

/// Changes the ends of the brightest blocks until each channel's mean is within 0.2 %, as far as possible.
void balance_bc6h(const std::vector<LatLongView>& pictures, const BlockFormat& format, EncodedLevels::Level& level);

}  // namespace welkin::image
