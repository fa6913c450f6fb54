// Images in blocks of 4 x 4 texels, the faces of cubemaps among them: which blocks are encoded together, and where
// they go. BC6H and UASTC HDR are formats of such blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "image/bc6h.h"
#include "image/bc6h_kernels.h"
#include "image/pixels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {

/// Puts a block into its lane.
inline void set_block(EncodedBlocks& blocks, std::size_t lane, const std::uint8_t* block, float error) noexcept {
  for (std::size_t k = 0; k < 4; ++k) std::memcpy(&blocks.words[k][lane], block + 4 * k, 4);
  blocks.errors[lane] = error;
}

/// Returns a lane's block.
[[nodiscard]] inline std::array<std::uint8_t, kBlockBytes> block_of(const EncodedBlocks& blocks,
                                                                    std::size_t lane) noexcept {
  std::array<std::uint8_t, kBlockBytes> block{};
  for (std::size_t k = 0; k < 4; ++k) std::memcpy(block.data() + 4 * k, &blocks.words[k][lane], 4);
  return block;
}

// The light of blocks of texels: which of a level's have so much that their errors show in its mean.
//
// The error of a channel's mean over a level comes from few blocks: if a sun lies in two of them, one step of an end, 3
// % of a value in BC6H, is 1 % of all light. The errors of all other blocks cancel.

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

// How images are encoded.

/// Levels in blocks, and what was measured on the way.
struct EncodedLevels {
  struct Level {
    std::vector<std::uint8_t> blocks;  ///< of one image after the other, rows of blocks from the top
    std::vector<BlockLight> lights;    ///< of the given texels of each block
    double squares = 0.0;              ///< the sum of squared errors, in units of the halves' last bits
  };
  std::vector<Level> levels;
  std::uint64_t values_clamped = 0;
};

/// A format, and how its blocks are encoded.
struct BlockFormat {
  Bc6hEffort effort;
  bool is_signed;
  /// One line for each block. Called with what `Bc6hKernels::prepare` makes; may change the values of the group.
  void (*encode_single_lines)(BlockGroup& group, const BlockFormat& format, EncodedBlocks& to);
  /// Two lines, for blocks that one was not enough for: the group as the function above left it.
  void (*encode_two_lines)(const BlockGroup& group, const BlockFormat& format, EncodedBlocks& to);
  /// Changes a level's brightest blocks to keep each channel's mean, once all are encoded.
  void (*balance)(const std::vector<LatLongView>& images, const BlockFormat& format, EncodedLevels::Level& level);

  /// Returns how many partitions of a block are encoded.
  [[nodiscard]] int partitions_tried() const noexcept { return effort == Bc6hEffort::slow ? kMaxPartitionsTried : 1; }
  /// The least value that a block can hold.
  [[nodiscard]] float least() const noexcept { return is_signed ? -kLargestHalf : 0.0F; }
};

/// Encodes the images of each level, which have the same size within a level, and balances them. Throws `Error`:
/// invalid_argument (the effort), cancelled; `std::bad_alloc`.
[[nodiscard]] EncodedLevels encode_images(std::span<const std::vector<LatLongView>> levels, const BlockFormat& format,
                                          const Control& control);

/// Encodes them in BC6H; as `encode_bc6h` otherwise.
[[nodiscard]] EncodedLevels encode_bc6h_images(std::span<const std::vector<LatLongView>> levels,
                                               const Bc6hOptions& options, const Control& control);

/// Encodes them in blocks of `uastc_hdr.h`.
[[nodiscard]] EncodedLevels encode_uastc_hdr_images(std::span<const std::vector<LatLongView>> levels, Bc6hEffort effort,
                                                    const Control& control);

/// The weight of texels beyond an image's edge.
inline constexpr float kPaddingWeight = 1.0F / 1024.0F;

/// A block's texels as half floats hold them, from `least` on; those beyond its image's edge repeat the last ones.
struct BlockTexels {
  std::array<float, 3 * kBlockTexels> values;
  std::array<bool, kBlockTexels> inside;
};
/// `block`: counted over all images of a level.
[[nodiscard]] BlockTexels block_texels(const std::vector<LatLongView>& images, std::size_t block, float least) noexcept;

/// Writes the block's texels to all lanes, with those weights that are given to `Bc6hKernels::prepare`.
void fill_group(const BlockTexels& texels, BlockGroup& group) noexcept;

/// A cubemap's faces, each as an image.
[[nodiscard]] std::vector<LatLongView> images_of(const CubemapView& view);

/// Bytes of an image in blocks.
[[nodiscard]] std::size_t block_bytes(int width, int height) noexcept;

[[nodiscard]] std::int64_t texels_of(const std::vector<LatLongView>& images) noexcept;

}  // namespace welkin::image
