// The inner loops, as a table of functions for each instruction set.
//
// A kernel takes pointers and numbers and gives numbers: no allocation, no locks, no exceptions, no
// library types. The choice of a table is made once a job, not once a call.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/basis_recurrence.h"
#include "sky/sky_kernels.h"
#include "transform/transform_kernels.h"
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

/// A product rule for the integrals of `DirectionalAlbedo` and `SheenAlbedo` (specular/brdf_quadrature.h).
struct AlbedoRule {
  int azimuths;
  const float* azimuth_cosines;
  const float* azimuth_weights;
  int radii;
  const float* radius_places;  ///< in (0, 1)
  const float* radius_weights;
};

/// e^-13: where the GGX integral ends, its tail being below 1e-6.
inline constexpr float kAlbedoTail = 2.26e-6F;
/// The sheen integral ends where its density is e^-14 of the largest.
inline constexpr float kSheenTail = 14.0F;

/// For sixteen cosines against the normal: directional albedo of GGX with Fresnel 1 (`whole`), and the part of it that
/// Schlick's (1 - v.h)^5 weighs (`fresnel`). 0 < alpha <= 1.
using DirectionalAlbedo = void (*)(const AlbedoRule& rule, float alpha, const float* normal_view, float* whole,
                                   float* fresnel);
/// The same of Charlie sheen.
using SheenAlbedo = void (*)(const AlbedoRule& rule, float alpha, const float* normal_view, float* albedo);

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

/// lengths[k] = sqrt(u[k]^2 + v^2), k < count.
using PlaneLengths = void (*)(const double* u, double v, int count, double* lengths);

/// places[k] = `offset` + `quarter` times the angle of the point (along[k], across[k]) from the axis along in quarter
/// turns, for k < count and coordinates >= 0; (0, 0) has the angle 0. Error of the angle: 1e-12. The product is rounded
/// to a multiple of 2^-32, so that what is added to it later, in halves and whole numbers below 2^19, rounds nothing;
/// with across and along exchanged it is `quarter` less the product.
using PlacesOfAngles = void (*)(const double* across, const double* along, int count, double quarter, double offset,
                                double* places);

/// Which of a grid's texels a place lies between, texel k's centre being at k, and what the four from first[i] on weigh
/// there: by the cubic B-spline, or linearly (the outer two nothing). weights: [count][4].
using TapsOfPlaces = void (*)(const double* places, int count, bool cubic, std::int32_t* first, float* weights);

/// Points of a row of a picture, on a grid of texels of four floats (red, green, blue, unused).
struct GridRun {
  const float* origin;         ///< ring 0, column 0
  std::ptrdiff_t ring_stride;  ///< floats from a ring to the next
  const std::int32_t* rings;   ///< [count]: first of the four rings around each point
  const std::int32_t* columns;
  const float* ring_weights;  ///< [count][4]
  const float* column_weights;
  int count;
  bool not_negative;  ///< results below 0 become 0
};

/// rgb[3 i + c] = the sum over the 4 x 4 texels around point i of texel times weight of its ring times weight of its
/// column. Nothing beyond rgb[3 count - 1] is written.
using SampleGrid = void (*)(const GridRun& run, float* rgb);

/// Points of a picture of texels of four floats, each the weighted sum of a patch of texels of its own.
struct PatchRun {
  const float* origin;          ///< row 0, column 0
  std::ptrdiff_t row_stride;    ///< floats from a row to the next
  const std::int32_t* rows;     ///< [count]: first row of each patch
  const std::int32_t* columns;  ///< [count]: first column
  std::int32_t base;            ///< column 0's place in the picture
  bool mirrored;                ///< columns count to the left from the one before `base`
  /// [count][patch_rows][4 patch_groups]; or those of columns only, [count][4 patch_groups], with `row_weights`
  const float* weights;
  const float* row_weights;  ///< [count][patch_rows]: factors of the weights of columns; or null
  int patch_rows;
  int patch_groups;  ///< of four columns
  int count;
  std::ptrdiff_t rgb_step;  ///< floats from a point's result to the next one's
};

/// rgb[rgb_step k + c] = the sum of weight times texel over point k's patch; where all its texels are equal, that value
/// itself. Rows are added one after the other (weights of columns are multiplied after that), then groups, then the
/// four columns as SampleGrid does.
using SamplePatches = void (*)(const PatchRun& run, float* rgb);

/// rgb[3 i + c] = (top w + bottom w of texel 2 i) + (the same of texel 2 i + 1), i < count: 2 x 2 texels of two rows of
/// packed RGB, weighted each on its own. A texel's weight stands in all three of its channels' places: [6 count].
using ReducePairs = void (*)(const float* top, const float* bottom, const float* top_weights,
                             const float* bottom_weights, int count, float* rgb);

/// Points of a line in space: `start` + u[k] `step`, k < count, none of them 0.
struct DirectionRun {
  double start[3];
  double step[3];
  const double* u;
  int count;
};

/// rgb[3 k + c] = the sum of coefficients[bands^2 c + l (l + 1) + m] Y(l, m) over l < bands at each point's direction,
/// in double, rounded once.
using EvaluateHarmonics = void (*)(const DirectionRun& run, const BasisRecurrence& recurrence,
                                   const double* coefficients, int bands, float* rgb);

/// True if any of `count` values lies outside [low, high] or is NaN.
using AnyOutside = bool (*)(const float* values, int count, float low, float high);

/// Adds up 16 `groups` floats, as fast as memory gives them: the yardstick for bandwidth.
using ReadAll = float (*)(const float* values, std::int64_t groups);

/// A light of no extent; its colour holds all that one mip's lobe does not change from texel to texel.
struct LobeLight {
  float x, y, z;  ///< unit direction
  float red, green, blue;
  float half_width;  ///< of what it stands for, radians, above 0: the horizon cuts it little by little
  float half_slope;  ///< 1 / (4 half_width)
};

/// A row of a cubemap face, and the lobe. Texel i's centre is at base + u along, u = (2 i + 1) step - 1.
struct LobeRow {
  float base[3];
  float along[3];
  float step;  ///< 1 / texels along an edge
  int count;
  float alpha_squared;
  float half_slope;  ///< (1 - alpha^2) / 4
};

/// Adds to each texel, packed RGB, the sum over lights of colour max(0, c) / (alpha^2 + (1 - c) (1 - alpha^2) / 2)^2,
/// c = cosine between texel and light: relative error 2e-6 + 1e-7 / alpha for positive light.
using AddLobes = void (*)(const LobeRow& row, const LobeLight* lights, int count, float* rgb);

/// What a run of values holds; `sum` and the bounds mean something only if all are finite.
struct RowMeasure {
  float sum;  ///< rounded in float, always alike
  float least;
  float largest;
  bool finite;
};
using MeasureRow = RowMeasure (*)(const float* values, int count);

struct Kernels {
  DirectionalAlbedo directional_albedo;
  SheenAlbedo sheen_albedo;
  FoldQuadrants fold_quadrants[fold_format_count];
  FoldHalves fold_halves[fold_format_count];
  WeightedSums weighted_sums;
  FoldSumLanes fold_sum_lanes;
  IntegrateTexels integrate_texels;
  ExpandTexels expand_texels;
  PlaneLengths plane_lengths;
  PlacesOfAngles places_of_angles;
  TapsOfPlaces taps_of_places;
  SampleGrid sample_grid;
  SamplePatches sample_patches;
  ReducePairs reduce_pairs;
  EvaluateHarmonics evaluate_harmonics;
  AnyOutside any_outside;
  ReadAll read_all;
  AddLobes add_lobes;
  MeasureRow measure_row;
  TransformKernels transform;
  SkyKernels sky;
  SkyViewKernels sky_view;
  SkyRingKernels sky_rings;
};

/// The table for one instruction set, which this machine must be able to run.
[[nodiscard]] const Kernels& kernels(InstructionSet set);

/// The table in use. Throws like `active_instruction_set`.
[[nodiscard]] inline const Kernels& active_kernels() { return kernels(active_instruction_set()); }

}  // namespace welkin::simd
