// The kernels of strips: 16 rows of pixels to a few moments, moments times weights to sums.
//
// A basis function's integral over a texel changes so little over 16 rows that a polynomial of the row gives it to a
// float's precision. So what a strip adds to a projection follows from a few moments of its columns, that is from its
// rows times polynomials of the row, and weights are applied to those: to a quarter or a third as many values.
//
// With x = row - 7.5 in a strip, i = |x| - 1/2 and binomials B, the polynomials are
//   even, degree 2 j:      B(i + j, 2 j)                            1, i (i + 1) / 2, ...
//   odd, degree 2 j + 1:   sign(x) (2 i + 1) / (2 j + 1) B(i + j, 2 j)   2 x, ...
// which are small integers at every row. Moments come in this order: even 0, odd 0, even 1, odd 1, ...
#pragma once

#include <cstddef>

#include "simd/dispatch.h"

namespace welkin::projection {

inline constexpr int kStripRows = 16;
/// Positions that the kernels take at once, at most: the moments of a segment and its weights stay in the second-level
/// cache.
inline constexpr int kSegment = 512;
inline constexpr int kFewestMoments = 4;
inline constexpr int kMostMoments = 6;
/// Harmonics of the three bands that strips are made for.
inline constexpr int kStripFunctions = 9;
/// Faces whose moments are multiplied with the weights at once.
inline constexpr int kFacesAtOnce = 2;

/// From one row of moments to the next, in floats. (A power of two would bring all rows to the same few lines of a
/// cache.) Holds the texels' three channels and what `SumStrip` may overwrite behind them.
inline constexpr int moment_stride(int positions) { return 3 * positions + simd::kLanes; }

/// Lines of rectangles of memory, to be asked for one after the other.
struct FetchList {
  struct Area {
    const char* first;
    std::ptrdiff_t row_stride;
    int lines;  ///< of each row
    int rows;
  };
  Area areas[4];
  int area_count = 0;
  int area = 0;  ///< where it goes on
  int row = 0;
  int line = 0;
};

/// Where a strip lies: its first row's first texel, and how far the next row is in bytes (upwards if negative).
struct StripRows {
  const void* first;
  std::ptrdiff_t stride;
};

/// moments[k][3 t + c] = the k-th moment of channel c of column t, t < `texels` (a multiple of 16), from one row of
/// moments to the next `stride` floats. Added up from the outer rows to the inner ones. Asks for `lines` lines of the
/// list (a power of two to 16, or 0) with every 16 values.
using SumStrip = void (*)(const StripRows& rows, int texels, FetchList& fetch, int lines, float* moments, int stride);

enum StripFormat { strip_rgb32f, strip_rgba32f, strip_rgba16f, strip_format_count };

/// The order of texels reversed in each of `count` rows of moments: from -> to, both as `SumStrip` stores them.
using ReverseMoments = void (*)(const float* from, int count, int texels, int stride, float* to);

/// What moments weigh, from weights at as many rows as there are moments, which lie symmetrically about the strip's
/// middle: first those above it from the outermost on, the middle one if their number is odd, and last those below,
/// the innermost first.
struct MomentsFromRows {
  int moments;
  /// even[j][a] times the sum of the weights at the a-th pair of rows (or the middle row's) gives even moment j,
  /// odd[j][a] times their difference (below less above) odd moment j.
  float even[3][3];
  float odd[3][3];
};

/// rows: [moments][9][row_stride], 16 `groups` positions. weights: [group][moments][9][48], each position's weight once
/// for each channel.
using WeighMoments = void (*)(const MomentsFromRows& matrix, const float* rows, int row_stride, int groups,
                              float* weights);

/// The moments of one face: four mirrored pieces, one after the other: top left, top right, bottom left, bottom right,
/// [4][moments][moment_stride]; the bottom ones are counted from the bottom, the right ones reversed.
/// sums[channel][9][kSumLanes] of each face += weight times moment, classes and their order as in FoldQuadrants and
/// WeightedSums: 16 lanes in float over all moments and groups, then lanes k + k + 8, then the addition in double.
/// Asks for `lines` lines of the list (a power of two to 16, or 0) three times for every 16 positions and moment.
struct StripMoments {
  const float* faces[kFacesAtOnce];
  double* sums[kFacesAtOnce];
  int face_count;
};
using SumMoments = void (*)(const StripMoments& moments, int moment_count, int groups, const float* weights,
                            FetchList& fetch, int lines);

struct StripKernels {
  SumStrip sum_strip[strip_format_count][kMostMoments - kFewestMoments + 1];
  ReverseMoments reverse_moments;
  WeighMoments weigh_moments;
  SumMoments sum_moments;
};
WELKIN_KERNEL_TABLES(StripKernels, strip_kernels)

}  // namespace welkin::projection
