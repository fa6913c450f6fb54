// The kernel of strips: 16 rows of pixels to a few moments, moments times weights to sums.
//
// A basis function's integral over a texel changes so little over 16 rows that a polynomial of the row gives it to a
// float's precision. So what a strip adds to a projection follows from a few moments of its columns, that is from its
// rows times polynomials of the row, and weights are applied to those: to a quarter or a third as many values. A strip
// at the top of a face, the one at the bottom and their left and right halves are mirror images, which share weights.
//
// With x = row - 7.5 in a strip, i = |x| - 1/2 and binomials B, the polynomials are
//   even, degree 2 j:      B(i + j, 2 j)                            1, i (i + 1) / 2, ...
//   odd, degree 2 j + 1:   sign(x) (2 i + 1) / (2 j + 1) B(i + j, 2 j)   2 x, ...
// which are small integers at every row. Moments come in this order: even 0, odd 0, even 1, odd 1, ...
#pragma once

#include <cstddef>

#include "projection/projection_kernels.h"
#include "simd/dispatch.h"

namespace welkin::projection {

// The reason: let w(x) be what a texel in row x of a column weighs. A polynomial of degree n - 1 that meets w to 5e-8
// is w(x) = sum over j of c_j P_j(x), so
//   sum over rows of w(x) L(x) = sum over j of c_j M_j,   M_j = sum over rows of P_j(x) L(x):
// the rows are needed for the n moments M_j only, and the c_j serve all faces. The P_j are central factorials: with the
// central difference d, d^2 P_j = P_(j - 1) among the even ones and among the odd ones, which makes means over rows
// simple (strip_weights.cpp). Odd ones are whole because (2 i + 1) / (2 j + 1) B(i + j, 2 j) = B(i + j + 1, 2 j + 1) +
// B(i + j, 2 j + 1). At i = 7 the largest are 126 and 378 (j = 2), so a product with a half float of 11 bits does not
// round.
inline constexpr int kStripRows = 16;
/// Positions to the left of a face's middle that are taken at once, at most, with their mirror images: their weights
/// stay in the second-level cache from face to face.
inline constexpr int kSegment = 256;
inline constexpr int kMinMoments = 4;
inline constexpr int kMaxMoments = 6;
/// Bands whose harmonics `SumStrips` weighs, and how many these are.
inline constexpr int kStripBands = 3;
inline constexpr int kStripFunctions = 9;
/// Columns of which all rows are read before the next ones. Longer runs are read faster from memory, shorter ones leave
/// their moments in the first-level cache. (Measured on Zen 3: at 1024 and 2048 half as many take 2 to 5 % longer, a
/// quarter 15 %; at 256 twice as many 8 %.)
inline constexpr int strip_block(int moments) { return moments == 4 ? 256 : moments == 5 ? 128 : 64; }

/// From one moment of a block to the next, in floats: three channels, and what `store_without_fourth` writes behind.
inline constexpr int moment_stride(int moments) { return 3 * strip_block(moments) + simd::kLanes; }

/// Floats that `FoldStrips` writes for each moment.
inline constexpr int kStripPlaneFloats = 3 * kMaximumClasses * kChunk;

/// Floats that the kernel works in, for texels of up to four channels: moments of four pieces, of one in the other
/// order and of half a piece's rows.
inline constexpr int strip_scratch(int moments) {
  return moments * (5 * moment_stride(moments) + 4 * strip_block(moments));
}

/// A piece of a strip: its first row's first texel, and how far the next row is in bytes (upwards if negative).
struct StripRows {
  const void* first;
  std::ptrdiff_t stride;
};

/// Four mirrored pieces: rows of the bottom ones are counted from the bottom.
struct StripPieces {
  StripRows top_left, top_right, bottom_left, bottom_right;
};

/// Sums pieces of `texels` columns (a multiple of 16), the right ones taken from right to left:
///   sums[channel][9][kSumLanes] += the sum over moments and columns of weight times moment,
/// classes and their order as in FoldQuadrants and `weighted_sums`: 16 lanes for the columns in float, over all moments
/// and groups of 16 columns, then lanes k + k + 8, then the addition in double.
/// weights: [group][moments][9][48], each column's weight once for each channel. scratch: `strip_scratch` floats.
using SumStrips = void (*)(const StripPieces& pieces, int texels, const float* weights, float* scratch, double* sums);

/// The moments' classes, for any number of functions to be weighed by `weighted_sums`:
///   planes[moment][channel][class][kChunk], from pieces of `texels` columns (a multiple of 16, at most kChunk).
using FoldStrips = void (*)(const StripPieces& pieces, int texels, float* scratch, float* planes);

/// Weights of moments, from weights at as many rows as there are moments, which lie symmetrically about the strip's
/// middle: first those above it from the outermost on, the middle one if their number is odd, and last those below,
/// the innermost first.
struct MomentsFromRows {
  int moments;
  /// even[j][a] times the sum of the weights at the a-th pair of rows (or the middle row's) gives even moment j,
  /// odd[j][a] times their difference (below less above) odd moment j.
  float even[3][3];
  float odd[3][3];
};

/// Both ways from a format's pixels on.
struct StripFunctions {
  SumStrips sum = nullptr;
  FoldStrips fold = nullptr;
};

struct StripKernels {
  struct ByMoments {
    StripFunctions of[kMaxMoments - kMinMoments + 1];
  };
  ByMoments strips[fold_format_count];  ///< null for formats that `fold_format` never gives

  /// rows: [moments][9][row_stride], 16 `groups` columns. weights: as `SumStrips` reads them.
  void (*weigh_moments)(const MomentsFromRows& matrix, const float* rows, int row_stride, int groups, float* weights);

  /// rows: [moments][functions][row_stride]. weights: [moments][functions][kChunk].
  void (*weigh_planes)(const MomentsFromRows& matrix, const float* rows, int row_stride, int functions, int groups,
                       float* weights);
};
WELKIN_KERNEL_TABLES(StripKernels, strip_kernels)

}  // namespace welkin::projection
