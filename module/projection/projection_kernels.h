// The kernels of projection: pixels to planes of symmetry classes, planes times weights to sums, checks of rows of
// pixels, and harmonics back to directions.
#pragma once

#include <cstddef>
#include <cstdint>

#include "math/basis.h"
#include "platform/compiler.h"
#include "simd/dispatch.h"
#include "welkin/image.h"

namespace welkin::projection {

/// Weighted sums run over chunks of at most this many positions: 16 groups of 16 lanes. A chunk's pixels (planes) and
/// weights stay in the first-level cache, and a lane rounds at most 17 sums in float (each to 6e-8 of itself) before
/// they go on in double.
inline constexpr int kChunk = 256;

/// Lanes over which sums are spread in double.
inline constexpr int kSumLanes = 8;

/// Symmetry classes of positions mirrored in u and in v.
/// A cubemap uses all four (even/even, odd/even, even/odd, odd/odd in u/v); a lat-long the first two.
inline constexpr int kMaximumClasses = 4;

/// How many weighted sums each class has; weights are ordered by class.
struct ClassCounts {
  int count[kMaximumClasses];
};

/// Which formats the folding kernels read directly; all others are decoded to rgb32f first.
enum FoldFormat {
  fold_rgb32f,
  fold_rgba32f,
  fold_rgba16f,
  fold_rgb16f,
  fold_rgb8,
  fold_rgba8,
  fold_srgb8,
  fold_srgba8,
  fold_format_count
};

/// A byte of the sRGB transfer function.
struct SrgbByte {
  std::uint8_t value;
};

/// Whether there are kernels that fold it. WebAssembly has those of the formats that engines render to.
[[nodiscard]] constexpr bool folds(FoldFormat format) { return !platform::kCodeIsSent || format <= fold_rgba16f; }

/// How the folding kernels read a format; `fold_format_count` if they do not.
[[nodiscard]] inline FoldFormat fold_format(PixelFormat format) {
  const auto if_folded = [](FoldFormat fold) { return folds(fold) ? fold : fold_format_count; };
  switch (format) {
    case PixelFormat::rgb32f: return fold_rgb32f;
    case PixelFormat::rgba32f: return fold_rgba32f;
    case PixelFormat::rgba16f: return fold_rgba16f;
    case PixelFormat::rgb16f: return if_folded(fold_rgb16f);
    case PixelFormat::rgb8: return if_folded(fold_rgb8);
    case PixelFormat::rgba8: return if_folded(fold_rgba8);
    case PixelFormat::srgb8: return if_folded(fold_srgb8);
    case PixelFormat::srgba8: return if_folded(fold_srgba8);
    default: return fold_format_count;
  }
}

/// Memory that will be read soon: four stretches of `lines` cache lines each.
///
/// The runs of a face are too short for a processor to see by itself where the next one begins, so the
/// kernels prefetch it, a few lines per iteration all through the work: a core has approximately sixteen
/// misses in flight at once, a burst only fills those and stalls, and a pause leaves memory idle. (Measured
/// at 1024 texels on two threads, as a share of read bandwidth: no fetching 60 %, all of it while folding
/// 67 %, all of it while summing 72 %, spread over both 80 %.)
struct FetchAhead {
  const char* stretches[4];
  int lines;  ///< 0: nothing is fetched
};

/// Four mirrored runs of several rows each: first texels in memory order, and how far the next row is, in
/// bytes; the bottom ones run upwards.
struct QuadrantRuns {
  const void* top_left;
  const void* top_right;
  const void* bottom_left;
  const void* bottom_right;
  std::ptrdiff_t top_stride;
  std::ptrdiff_t bottom_stride;
  int rows;
};

/// Reads runs of 16 `groups` texels from four mirrored places of a face, deinterleaves them and adds and
/// subtracts them into their symmetry classes.
///
/// Position k of a row is texel k of the left runs and texel 16 groups - 1 - k of the right ones (mirrored
/// in u). planes[channel][class][kChunk], written from position 0, row after row:
///   class 0: TL + TR + BL + BR    class 1: (TR + BR) - (TL + BL)
///   class 2: (BL + BR) - (TL + TR)    class 3: (TL + BR) - (TR + BL)
///
/// Each group prefetches one more line of each of the stretches ahead: `groups` times `runs.rows` of them.
using FoldQuadrants = void (*)(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes);

/// Reads two runs of 16 `groups` texels, the second 180 degrees on: planes[channel][class][kChunk],
///   class 0: first + second    class 1: first - second
/// Each group prefetches one more line of each of the stretches ahead.
using FoldHalves = void (*)(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes);

/// Points of a line in space: `start` + u[k] `step`, k < count, none of them 0.
struct DirectionRun {
  double start[3];
  double step[3];
  const double* u;
  int count;
};

/// True if any of `count` values lies outside [low, high] or is NaN.
using AnyOutside = bool (*)(const float* values, int count, float low, float high);

/// Measures of a run of values; `sum` and the bounds mean something only if all are finite.
struct RowMeasure {
  float sum;  ///< rounded in float, always alike
  float least;
  float largest;
  bool finite;
};
struct ProjectionKernels {
  FoldQuadrants fold_quadrants[fold_format_count];
  FoldHalves fold_halves[fold_format_count];

  /// For each channel and each weight w of class c, with lane k of 16 groups adding up its products in float:
  ///   sums[channel][w][k] += lane k + lane k + 8, k < 8: that sum in float, its addition in double.
  ///   planes: [3][class_count][kChunk]    weights: [total][kChunk]    sums: [3][total][kSumLanes]
  /// Sums stay spread over eight lanes so that a chunk costs few instructions to add; `fold_sum_lanes` ends it.
  ///
  /// Meanwhile prefetches the lines ahead that FoldQuadrants has left, after `groups` of each stretch.
  void (*weighted_sums)(const float* planes, int class_count, const float* weights, const ClassCounts& counts,
                        int groups, const FetchAhead& ahead, double* sums);

  /// sums[i] = the sum of lanes[i][kSumLanes], i < count, always in the same order: halves of 4, of 2, of 1.
  void (*fold_sum_lanes)(const double* lanes, int count, double* sums);

  /// rgb[3 k + c] = the sum of coefficients[bands^2 c + l (l + 1) + m] Y(l, m) over l < bands at each point's
  /// direction, in double, rounded once.
  void (*evaluate_harmonics)(const DirectionRun& run, const math::BasisRecurrence& recurrence,
                             const double* coefficients, int bands, float* rgb);
  AnyOutside any_outside;
  RowMeasure (*measure_row)(const float* values, int count);
};
WELKIN_KERNEL_TABLES(ProjectionKernels, projection_kernels)

}  // namespace welkin::projection
