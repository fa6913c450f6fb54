// The kernels of UASTC HDR's encoder: 16 blocks at once, one in each logical lane. BC6H's load and prepare them.
#pragma once

#include <cstdint>

#include "image/bc6h_kernels.h"
#include "simd/dispatch.h"

namespace welkin::image {

/// Halves' bits as numbers to the logarithms of ASTC: the middle of those that become this half. flat[block]: 1 if all
/// texels of a block are equal, else 0.
using TakeLogarithms = void (*)(BlockGroup& group, std::int32_t* flat);

/// Lines of 16 blocks, in logarithms: [line][low, high][channel][block]. A block with one line has the first.
struct alignas(64) BlockLines {
  float ends[2][2][3][simd::kLanes];
};

/// The lines that are nearest to the texels. `stored`: if the texels keep the indices that these lines give them;
/// null: if they lie along the direction in which they spread most.
using FitSingle = void (*)(const BlockGroup& group, const BlockLines* stored, BlockLines& fitted);
using FitPairs = void (*)(const BlockGroup& group, const float* partitions, const BlockLines* stored,
                          BlockLines& fitted);

/// The indices of texels along stored lines.
struct alignas(64) BlockIndices {
  std::int32_t indices[16][simd::kLanes];
  float errors[simd::kLanes];  ///< sums of squares, in units of the halves' last bits
};
using IndexSingle = void (*)(const BlockGroup& group, const BlockLines& stored, BlockIndices& to);
using IndexPairs = void (*)(const BlockGroup& group, const float* partitions, const BlockLines& stored,
                            BlockIndices& to);

/// The partitions among `allowed` (bit k for k) that promise most: partitions[rank][block], the best one first.
using RankPartitions = void (*)(const BlockGroup& group, std::uint32_t allowed, int slots,
                                float (*partitions)[simd::kLanes]);

struct UastcHdrKernels {
  TakeLogarithms take_logarithms;
  FitSingle fit_single;
  IndexSingle index_single;
  RankPartitions rank_partitions;
  FitPairs fit_pairs;
  IndexPairs index_pairs;
};
WELKIN_KERNEL_TABLES(UastcHdrKernels, uastc_hdr_kernels)

}  // namespace welkin::image
