// The light of blocks of texels: which of a level's have so much that their errors show in its mean.
//
// A channel's mean over a level is off by what few blocks leave out: where a sun lies in two of them, a step of an end,
// which is 3 % of a value in BC6H, is 1 % of all light. The errors of all other blocks cancel out.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace welkin::image {

/// A block's sums of the magnitudes of its values, by channels.
using BlockLight = std::array<float, 3>;
using ChannelSums = std::array<double, 3>;

[[nodiscard]] ChannelSums total_light(std::span<const BlockLight> lights) noexcept;

/// A block and the part of a level's light that it has, of the channel of which it has most.
struct BlockShare {
  double share;
  std::size_t block;
};

/// From here on a block is tried several times over.
inline constexpr double kLargeShare = 0.15;

/// A mean that is off by less is good enough.
inline constexpr double kMeanTolerance = 0.002;

/// The blocks with a hundredth or more, those with most first.
[[nodiscard]] std::vector<BlockShare> brightest_blocks(std::span<const BlockLight> lights, const ChannelSums& total);

/// How much more than the tolerance a channel's mean is off: the sum of values by `off`, of `total`.
[[nodiscard]] double excess_of_mean(double off, double total) noexcept;

}  // namespace welkin::image
