// The inner loops of the spherical harmonic transform: Fourier transforms across rings, Legendre sums down them.
//
// Rings of latitude come in pairs, one north and one south of the equator; 16 pairs are a group, one pair a lane. A
// pair's even part (north + south) meets the Legendre functions that are even about the equator, its odd part the
// others: half the functions serve both halves.
#pragma once

#include <cstddef>

#include "simd/dispatch.h"

namespace welkin::transforms {

inline constexpr int kRingLanes = simd::kLanes;
inline constexpr int kComplexFloats =
    2 * kRingLanes;  ///< one complex number a lane: the real parts, the imaginary ones

/// Floats of a group of ring pairs for one order m: red, green and blue, each real and imaginary, [2][6][kRingLanes],
/// the even part and then the odd one.
inline constexpr int kColumnFloats = 12 * kRingLanes;

/// Floats for one (l, m): the same six numbers, and two that pad half a register.
inline constexpr int kHarmonicFloats = 8;

/// Rows of pixels (interleaved floats) that 16 ring pairs differ in; lane q's even part is (a - b) + (c - d), its odd
/// part (a - b) - (c - d).
struct RowQuads {
  const float* a[kRingLanes];
  const float* b[kRingLanes];
  const float* c[kRingLanes];
  const float* d[kRingLanes];
};

/// planes[channel][width][kComplexFloats] = even part + i odd part of rows of `width` rgb texels.
using LoadRowQuads = void (*)(const RowQuads& rows, int width, float* planes);

/// One pass of a Stockham Fourier transform of 16 signals at once, of length radix x count x stride:
///   out[q + stride (radix p + k)] = t(p, k) sum over j of in[q + stride (p + count j)] e^(-2 pi i j k / radix)
/// for p < count, q < stride, k < radix, with t(p, 0) = 1.
/// With a second radix (each then 2, 3, 4, 5 or 8) the two take the place of `radix`, as their product.
struct FourierPass {
  int radix;
  int second_radix;  ///< 1: none
  int count;
  int stride;
  const float* twiddles;        ///< t(p, k) at [p][k][real, imaginary]
  const float* inner_twiddles;  ///< with two: e^(-2 pi i p k / (radix second_radix)) at [p < second][k < radix]
  const float* roots;           ///< e^(-2 pi i j / radix) at [j][real, imaginary], read for radices above 8
};
using RunFourierPass = void (*)(const FourierPass& pass, const float* in, float* out);

/// out[k] = factors[k] in[k step] for k < count: complex, the factor the same in all lanes.
using MultiplyComplex = void (*)(const float* in, std::ptrdiff_t step, const float* factors, int count, float* out);

/// Parts the transform z of length `width` of (even + i odd), both real, for one channel's column numbers of orders
/// m < orders, doubled: column[m] = (z[m] + conj z[-m], (z[m] - conj z[-m]) / i), indices modulo width. Order m's
/// column begins at columns + m order_stride.
using PartOrders = void (*)(const float* z, int width, int orders, int channel, float* columns,
                            std::ptrdiff_t order_stride);

/// The way back: z[m] = north[m] + i south[m] and z[-m] = conj north[m] + i conj south[m], with north = even + odd and
/// south = even - odd; zero for m >= orders. width > 2 (orders - 1); m = 0 has no imaginary part.
using JoinOrders = void (*)(const float* columns, std::ptrdiff_t order_stride, int orders, int channel, int width,
                            float* z);

/// Writes rings of RGBA texels (fourth: 0) from three planes of `width` (north + i south); lane q to north[q] and
/// south[q]. A null pointer: nowhere.
struct RingRows {
  float* north[kRingLanes];
  float* south[kRingLanes];
};
using StoreRings = void (*)(const float* red, const float* green, const float* blue, int width, const RingRows& rows);

struct FourierKernels {
  LoadRowQuads load_row_quads;
  RunFourierPass run_fourier_pass;
  MultiplyComplex multiply_complex;
  PartOrders part_orders;
  JoinOrders join_orders;
  StoreRings store_rings;
};
WELKIN_KERNEL_TABLES(FourierKernels, fourier_kernels)

/// Legendre functions of one order m on groups of ring pairs, scaled so that
///   Q(l) = a(l) x Q(l - 1) - Q(l - 2).
/// Degrees come in fours k: l = m + 4k to m + 4k + 3, even and odd about the equator by turns.
/// Groups from `first_single` on have theirs in float, with x as the sum of two floats: only rounding at random is
/// left, which grows like sqrt(l) / sin(theta) x 6e-8. Nearer to the poles they are in double.
struct LegendreRun {
  const double* a;        ///< a(m + i) at [i], i < 4 fours + 6
  const float* a_single;  ///< the same
  const double* x;        ///< cosine of colatitude at [group][kRingLanes]
  const float* x_single;  ///< the same at [group][2][kRingLanes]: a float, and what it lacks
  const double* states;   ///< the first two Q of four starts[group], at [group][2][kRingLanes]
  const int* starts;      ///< first four in which a group does not vanish; never rises with the group
  int groups;
  int first_single;
  int fours;
};
[[nodiscard]] constexpr int fours_of(int degrees) { return (degrees + 3) / 4; }

/// The most groups of one call of AnalyseOrder: their columns and states stay in the first-level cache.
inline constexpr int kAnalysisGroups = 16;

/// sums[4 fours, or 4 more if `fours` is odd][kHarmonicFloats] += over all lanes, column x Q(l); a group's column
/// begins at columns + kColumnFloats group. `state`: [kAnalysisGroups][2][kRingLanes] numbers of scratch.
using AnalyseOrder = void (*)(const LegendreRun& run, const float* columns, double* state, float* sums);

/// column of each group = sum over l of coefficients[4 fours][kHarmonicFloats] Q(l).
using SynthesiseOrder = void (*)(const LegendreRun& run, const float* coefficients, float* columns);

/// Takes one group's state (two Q, [2][kRingLanes]) from P(m, m) on by fours until one of them reaches `threshold`, at
/// most `last` fours. How many it took: all of them if P(m, m) is 0 in all lanes. a(m + i) at [i]; sectoral, which is
/// P(m, m), and x: [kRingLanes].
using FindStart = int (*)(const double* a, const double* x, const double* sectoral, double threshold, int last,
                          double* state);

/// sums[6] = odd parts of `groups` columns, lane by lane times weights[group][kRingLanes], in double.
using WeighOddParts = void (*)(const float* columns, const double* weights, int groups, double* sums);

/// From Legendre sums to coefficients. J(l) = alpha(l) J(l - 2) - beta(l) sums(l - 1), started by J(m) = first and
/// J(m - 1) = 0, is written as phase x conj J to coefficients[count][kHarmonicFloats]; index i is l = m + i.
struct IntegralRun {
  const double* alpha;
  const double* beta;
  double first[6];
  double phase_real;
  double phase_imaginary;
  int count;
};
using IntegrateSums = void (*)(const IntegralRun& run, const float* sums, float* coefficients);

/// out[count][kHarmonicFloats] = (phase scale[i] gamma[i]) x in, complex.
struct ScaleRun {
  const double* scale;
  const double* gamma;
  double phase_real;
  double phase_imaginary;
  int count;
};
using ScaleHarmonics = void (*)(const ScaleRun& run, const float* in, float* out);

/// From samples down the meridians to the coefficients of their cubic B-spline, in place, for one order m: solves
/// (c[r - 1] + 4 c[r] + c[r + 1]) / 6 = f[r] / kSplineGain on the circle through both poles, beyond which the order's
/// sign is (-1)^m. Error: 1e-9 of the largest sample. `scratch`: spline_scratch_floats(groups).
struct SplineRun {
  int groups;
  int rings;  ///< of the whole sphere
  bool odd_order;
};
using SplineRings = void (*)(const SplineRun& run, float* columns, float* scratch);

/// 6 (2 - sqrt(3)): left to the caller, who multiplies coefficients anyway.
inline constexpr double kSplineGain = 1.6076951545867362;

inline constexpr int kSplineMargin = 32;
[[nodiscard]] constexpr std::size_t spline_scratch_floats(int groups) {
  return std::size_t{12} * (static_cast<std::size_t>(groups) * kRingLanes + std::size_t{2} * kSplineMargin);
}

/// column = sum over l of coefficients[degrees][kHarmonicFloats] functions[degrees][kRingLanes], for one group and
/// order m: degrees l = m, m + 2, ... in the even part, the others in the odd one. `degrees` is even.
using SumFunctions = void (*)(const float* functions, const float* coefficients, int degrees, float* column);

struct LegendreKernels {
  AnalyseOrder analyse_order;
  SynthesiseOrder synthesise_order;
  FindStart find_start;
  WeighOddParts weigh_odd_parts;
  IntegrateSums integrate_sums;
  ScaleHarmonics scale_harmonics;
  SplineRings spline_rings;
  SumFunctions sum_functions;
};
WELKIN_KERNEL_TABLES(LegendreKernels, legendre_kernels)

}  // namespace welkin::transforms
