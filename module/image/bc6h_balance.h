// The light of a level in BC6H: what its brightest blocks miss is made up for by their ends (block_light.h).
#pragma once

#include <cstdint>
#include <vector>

#include "image/bc6h.h"
#include "image/bc6h_kernels.h"
#include "image/block_light.h"
#include "welkin/image.h"

namespace welkin::image {

/// Four texels of a picture's row from `column` on; those beyond its edge repeat the last one.
void read_block_row(const LatLongView& view, int row, int column, float* rgb) noexcept;

/// A lane's block with two lines.
[[nodiscard]] Bc6hFields fields_of(const TwoLineBlocks& pair, std::size_t lane) noexcept;

/// Of texels beyond a picture's edge.
inline constexpr float kPaddingWeight = 1.0F / 1024.0F;

/// Changes the ends of the brightest blocks until each channel's mean is within 0.2 %, as far as they can.
/// `lights`: of each block of the pictures, which `blocks` holds; `squares`: the level's sum of squared errors in units
/// of the halves' last bits. Returns how much that grows.
double balance_bc6h(const std::vector<LatLongView>& pictures, bool is_signed, const std::vector<BlockLight>& lights,
                    double squares, std::uint8_t* blocks);

}  // namespace welkin::image
