// The kernels of BC6H's and UASTC HDR's encoders: 16 blocks at once, one in each logical lane.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/dispatch.h"

namespace welkin::image {

/// 16 blocks. Values stand by lanes: values[3 texel + channel][block].
struct alignas(64) BlockGroup {
  float values[48][simd::kLanes];
  /// Weights of the texels' errors. On input 1, or nearly 0 for texels that repeat the edge of an image.
  float weights[16][simd::kLanes];
};

/// Finished blocks.
struct alignas(64) EncodedBlocks {
  std::int32_t words[4][simd::kLanes];  ///< of a block, the lowest bits first
  float errors[simd::kLanes];           ///< sums of squares, in units of the halves' last bits
};

/// The numbers of blocks with two lines, modes 1 to 10, as `Bc6hFields` has them (ends with all their bits).
struct alignas(64) TwoLineBlocks {
  std::int32_t modes[simd::kLanes];
  std::int32_t partitions[simd::kLanes];
  std::int32_t ends[12][simd::kLanes];  ///< [3 end + channel]
  std::int32_t indices[16][simd::kLanes];
  float errors[simd::kLanes];
};

inline constexpr int kMaxPartitionsTried = 4;

/// 16 choices of one channel's ends of a line, as the decoder has them with 16 bits, and the line's texels: how far
/// along it each is, and its half's bits as a number.
struct alignas(64) EndTrials {
  float low[simd::kLanes];
  float high[simd::kLanes];
  float along[16];
  float wanted[16];
  // Results of each choice:
  float squares[simd::kLanes];  ///< in units of the halves' last bits
  float light[simd::kLanes];    ///< sum of the decoded values
  int texels;                   ///< of the line
};

struct Bc6hKernels {
  /// Loads values from packed RGB floats: rows[4 block + row] is a row of a block, four texels.
  void (*load)(const float* const* rows, BlockGroup& group);

  /// Radiance to the halves' bits as numbers (those of negative ones negative), each value rounded to the nearest half,
  /// and weights to what a texel's light makes them: w (1 + 2.5 L / mean of L). What the halves cannot hold is clamped,
  /// NaN is 0: clamped[block] says how many values of a block that were. light[channel][block]: the sum of the values'
  /// magnitudes, each times its texel's given weight.
  void (*prepare)(BlockGroup& group, bool is_signed, std::int32_t* clamped, float (*light)[simd::kLanes]);

  /// Modes 11 to 14. `refine`: the line is fitted once more to the indices that came of its first ends.
  void (*single_lines)(const BlockGroup& group, bool is_signed, bool refine, EncodedBlocks& blocks);

  /// `tried`: how many of the 32 partitions are encoded, those that promise most; 1 to `kMaxPartitionsTried`.
  void (*two_lines)(const BlockGroup& group, bool is_signed, int tried, TwoLineBlocks& blocks);

  /// Fills in the results of each choice.
  void (*try_ends)(EndTrials& trials, bool is_signed);
};
WELKIN_KERNEL_TABLES(Bc6hKernels, bc6h_kernels)

// Kernels of UASTC HDR, whose blocks are loaded and prepared by BC6H's.

/// Lines of 16 blocks, in logarithms: [line][low, high][channel][block]. Blocks with one line have the first.
struct alignas(64) BlockLines {
  float ends[2][2][3][simd::kLanes];
};

struct alignas(64) BlockIndices {
  std::int32_t indices[16][simd::kLanes];
  float errors[simd::kLanes];  ///< sums of squares, in units of the halves' last bits
};

struct UastcHdrKernels {
  /// Halves' bits as numbers to the logarithms of ASTC: the middle of those that become this half. flat[block]: 1 if
  /// all texels of a block are equal, else 0.
  void (*take_logarithms)(BlockGroup& group, std::int32_t* flat);

  /// The partitions among `allowed` (bit k for k) that promise most: partitions[rank][block], the best one first.
  void (*rank_partitions)(const BlockGroup& group, std::uint32_t allowed, int slots, float (*partitions)[simd::kLanes]);

  /// The lines that are nearest to the texels. `partitions`: of the blocks, which have two lines; null: they have one.
  /// `stored`: if the texels keep the indices that these lines give them; null: if they lie along the direction in
  /// which they spread most.
  void (*fit_lines)(const BlockGroup& group, const float* partitions, const BlockLines* stored, BlockLines& fitted);

  /// The indices that stored lines give the texels, and the errors of both.
  void (*index_lines)(const BlockGroup& group, const float* partitions, const BlockLines& stored, BlockIndices& to);
};
WELKIN_KERNEL_TABLES(UastcHdrKernels, uastc_hdr_kernels)

}  // namespace welkin::image
