// The inner loops, as a table of functions for each instruction set.
//
// A kernel takes pointers and numbers and gives numbers: no allocation, no locks, no exceptions, no
// library types. The choice of a table is made once a job, not once a call.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/basis_recurrence.h"
#include "welkin/instruction_set.h"

namespace welkin::simd {

/// Weighted sums run over chunks of at most this many positions: 16 groups of 16 lanes. A chunk's pixels
/// (planes) and weights stay in the first-level cache, and a lane rounds at most 17 sums in float (each to
/// 6e-8 of itself) before they go on in double.
inline constexpr int kLanes = 16;
inline constexpr int kChunk = 256;

/// Lanes over which sums are spread in double.
inline constexpr int kSumLanes = 8;

/// sums[i] = the sum of lanes[i][kSumLanes], i < count, always in the same order: halves of 4, of 2, of 1.
using FoldSumLanes = void (*)(const double* lanes, int count, double* sums);

/// Symmetry classes of positions mirrored in u and in v.
/// A cubemap uses all four (even/even, odd/even, even/odd, odd/odd in u/v); a lat-long the first two.
inline constexpr int kMaximumClasses = 4;

/// How many weighted sums each class has; weights are ordered by class.
struct ClassCounts {
  int count[kMaximumClasses];
};

/// Which formats the folding kernels read directly; all others are decoded to rgb_f32 first.
enum FoldFormat { fold_rgb_f32, fold_rgba_f32, fold_rgba_f16, fold_format_count };

/// Memory that will be read soon: four stretches of `lines` cache lines each.
///
/// The runs of a face are too short for a processor to see by itself where the next one begins, so the
/// kernels ask for it. They ask for a few lines an iteration all through the work: a core has some sixteen
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
/// Each group asks for one more line of each of the stretches ahead: `groups` times `runs.rows` of them.
using FoldQuadrants = void (*)(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes);

/// Reads two runs of 16 `groups` texels, the second half a turn on: planes[channel][class][kChunk],
///   class 0: first + second    class 1: first - second
/// Each group asks for one more line of each of the stretches ahead.
using FoldHalves = void (*)(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes);

/// For each channel and each weight w of class c, with lane k of 16 groups adding up its products in float:
///   sums[channel][w][k] += lane k + lane k + 8, k < 8: that sum in float, its addition in double.
///   planes: [3][class_count][kChunk]    weights: [total][kChunk]    sums: [3][total][kSumLanes]
/// Sums stay spread over eight lanes so that a chunk costs few instructions to add; FoldSumLanes ends it.
///
/// Meanwhile asks for the lines ahead that FoldQuadrants has left, after `groups` of each stretch.
using WeightedSums = void (*)(const float* planes, int class_count, const float* weights, const ClassCounts& counts,
                              int groups, const FetchAhead& ahead, double* sums);

/// Gauss-Legendre on [-1, 1].
struct GaussRule {
  int order;
  const double* nodes;
  const double* weights;
};

/// What a texel of a cubemap face stands for; positions are counted in the face's top left quadrant and
/// weights are those of its mirror image with u >= 0 and v >= 0.
struct TexelRun {
  int size;          ///< N, texels along an edge of the face
  int row;           ///< 0 to ceil(N/2) - 1
  int first_column;  ///< 0 to ceil(N/2) - 1
  int count;         ///< texels; positions from `count` to the next multiple of 16 get zero weights
  int bands;
  bool midpoint;  ///< solid angle times the value at the centre, instead of the integral
};

/// Integrals over each texel of the face-local harmonics Y(l, m)(u, v, 1), by a product Gauss rule in
/// double. `place[l(l+1)+m]` is the row of `weights` (row stride `stride` floats) that gets Y(l, m).
using IntegrateTexels = void (*)(const TexelRun& run, const BasisRecurrence& recurrence, const GaussRule& rule,
                                 const int* place, float* weights, int stride);

/// The same for up to three bands by the expansion in the texel's size h = 1/N, in float: relative error
/// 2e-7 + 40 h^4.
using ExpandTexels = void (*)(const TexelRun& run, const int* place, float* weights, int stride);

/// True if any of `count` values lies outside [low, high] or is NaN.
using AnyOutside = bool (*)(const float* values, int count, float low, float high);

/// Adds up 16 `groups` floats, as fast as memory gives them: the yardstick for bandwidth.
using ReadAll = float (*)(const float* values, std::int64_t groups);

struct Kernels {
  FoldQuadrants fold_quadrants[fold_format_count];
  FoldHalves fold_halves[fold_format_count];
  WeightedSums weighted_sums;
  FoldSumLanes fold_sum_lanes;
  IntegrateTexels integrate_texels;
  ExpandTexels expand_texels;
  AnyOutside any_outside;
  ReadAll read_all;
};

/// The table for one instruction set, which this machine must be able to run.
[[nodiscard]] const Kernels& kernels(InstructionSet set);

/// The table in use. Throws like `active_instruction_set`.
[[nodiscard]] inline const Kernels& active_kernels() { return kernels(active_instruction_set()); }

}  // namespace welkin::simd
