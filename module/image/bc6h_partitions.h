// Which texels of a BC6H block with two lines belong to which, for the decoder and for the kernels: plain numbers, as a
// kernel calls nothing outside, and not inline, as its objects define nothing that others could be linked to.
#pragma once

#include <cstdint>

namespace welkin::image {

/// Texel k of the second line is bit k (row by row). These are the first 32 of BC7's partitions, too.
constexpr std::uint16_t kBc6hSecondLines[] = {0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80,
                                              0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000,
                                              0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310, 0x3100, 0x8CCE,
                                              0x088C, 0x3110, 0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C};

/// The texel of the second line whose index has a bit less.
constexpr std::uint8_t kBc6hAnchors[] = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                         15, 2,  8,  2,  2,  8,  8,  15, 2,  8,  2,  2,  8,  8,  2,  2};

inline constexpr int kBc6hPartitions = 32;
static_assert(sizeof kBc6hSecondLines == kBc6hPartitions * sizeof(std::uint16_t) &&
              sizeof kBc6hAnchors == kBc6hPartitions);

}  // namespace welkin::image
