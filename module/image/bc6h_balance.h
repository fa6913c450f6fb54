// The light of a level in BC6H: the ends of its brightest blocks are changed to keep its mean (block_light.h). And how
// blocks are read from pictures, for all formats of blocks.
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

/// The weight of texels beyond a picture's edge.
inline constexpr float kPaddingWeight = 1.0F / 1024.0F;

/// Changes the ends of the brightest blocks until each channel's mean is within 0.2 %, as far as possible. `lights`:
/// the light of each block in `blocks`; `squares`: the level's sum of squared errors in units of the halves' last bits.
/// Returns by how much `squares` grows.
double balance_bc6h(const std::vector<LatLongView>& pictures, bool is_signed, const std::vector<BlockLight>& lights,
                    double squares, std::uint8_t* blocks);

}  // namespace welkin::image
