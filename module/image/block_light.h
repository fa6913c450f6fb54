// The light of blocks of texels: which of a level's have so much that their errors show in its mean.
//
// The error of a channel's mean over a level comes from few blocks: if a sun lies in two of them, one step of an end, 3
// % of a value in BC6H, is 1 % of all light. The errors of all other blocks cancel.
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

/// A block and its share of a level's light, in the channel in which that share is largest.
struct BlockShare {
  double share;
  std::size_t block;
};

/// The share from which on a block is tried several times.
inline constexpr double kLargeShare = 0.15;

/// The relative error of a mean below which nothing is changed.
inline constexpr double kMeanTolerance = 0.002;

/// Returns the blocks with a hundredth or more of the light, in descending order.
[[nodiscard]] std::vector<BlockShare> brightest_blocks(std::span<const BlockLight> lights, const ChannelSums& total);

/// Returns by how much the relative error of a channel's mean exceeds the tolerance: its sum of values is off by `off`,
/// of `total`.
[[nodiscard]] double excess_of_mean(double off, double total) noexcept;
/// Returns the sum of that over the channels.
[[nodiscard]] double excess_of_means(const ChannelSums& off, const ChannelSums& total) noexcept;

/// a + sign b
[[nodiscard]] inline ChannelSums sum(const ChannelSums& a, const ChannelSums& b, double sign = 1.0) noexcept {
  return {a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2]};
}

}  // namespace welkin::image
