#include "projection/strip_weights.h"

#include <algorithm>
#include <cmath>

#include "projection/texel_weights.h"

namespace welkin::projection {
namespace {

constexpr int kSmallestFace = 256;
constexpr int kSmallestAlike = 160;  ///< six moments leave 3e-8
constexpr double kOutermostRow = 7.5;

/// Zeros of the Chebyshev polynomial of degree `moments` between 0 and 1, cos((2 k + 1) pi / (2 moments)), largest
/// first. Interpolation there, stretched so that the outermost are the strip's first and last row, is nearly the best
/// approximation, and rounding of the weights grows least.
/// Between n zeros x_k on a length L the error is the n-th derivative of w times prod (x - x_k) / n!; with Chebyshev's
/// zeros the product is at most 2 (L / 4)^n. Stretched by 1 / cos(pi / (2 n)) to reach the outermost rows it is at most
/// 543, 1907 and 6848 for n = 4, 5 and 6 (L = 15 rows), and the sum of the magnitudes of Lagrange's polynomials, by
/// which rounding grows, is at most 1.43, 1.56 and 1.68 at any row.
constexpr double kZeros[kMaxMoments - kMinMoments + 1][3] = {
    {0.92387953251128676, 0.38268343236508977, 0.0},
    {0.95105651629515357, 0.58778525229247313, 0.0},
    {0.96592582628906829, 0.70710678118654752, 0.25881904510252076}};

/// The even polynomials of strip_kernels.h for any |x|: B(i + j, 2 j) is the product of x^2 - (m - 1/2)^2 over m from 1
/// to j, divided by (2 j)!.
double even_polynomial(int j, double x) {
  double value = 1.0;
  for (int m = 1; m <= j; ++m) value *= (x * x - (m - 0.5) * (m - 0.5)) / (2.0 * m * (2.0 * m - 1.0));
  return value;
}

double odd_polynomial(int j, double x) { return 2.0 * x / (2.0 * j + 1.0) * even_polynomial(j, x); }

/// The inverse of the leading part of a matrix, by elimination; the polynomials rise so fast that it needs no pivots.
void invert(double (&matrix)[3][3], int size) {
  for (int p = 0; p < size; ++p) {
    const double pivot = 1.0 / matrix[p][p];
    matrix[p][p] = 1.0;
    for (int c = 0; c < size; ++c) matrix[p][c] *= pivot;
    for (int r = 0; r < size; ++r) {
      if (r == p) continue;
      const double factor = matrix[r][p];
      matrix[r][p] = 0.0;
      for (int c = 0; c < size; ++c) matrix[r][c] -= factor * matrix[p][c];
    }
  }
}

/// Factors of even terms as floats that give a constant exactly, which is `constant` times the moment: what rounding
/// leaves there would bias the weights of all texels alike. So all are multiples of one power of two, and the last one
/// makes up the sum. `counts[a]` is how many rows the a-th factor stands for.
/// A constant weight must come out exactly: the sum over a of counts[a] rounded[a] has to be `constant`, 1 for moment 0
/// and 0 for the others. `grid` is the unit in the last place of the largest factor (2^-24 for factors from 1/2 to 1),
/// so every multiple of it up to there is a float. `left` begins as an even multiple of the grid and each pair takes
/// off an even one, so that halving what is left gives a multiple of the grid, too.
void round_even(const double* factors, const int* counts, int size, double constant, float* rounded) {
  double largest = 0.0;
  for (int a = 0; a < size; ++a) largest = std::max(largest, std::abs(factors[a]));
  double grid = 0x1p-24;
  for (double bound = 0.5; largest < bound; bound *= 0.5) grid *= 0.5;
  for (double bound = 1.0; largest >= bound; bound *= 2.0) grid *= 2.0;
  double left = constant;
  for (int a = 0; a + 1 < size; ++a) {
    const double multiple = std::floor(factors[a] / grid + 0.5) * grid;
    left -= counts[a] * multiple;
    rounded[a] = static_cast<float>(multiple);
  }
  rounded[size - 1] = static_cast<float>(left / counts[size - 1]);
}

/// From the polynomial's coefficients by its values at rows' middles to those of its means over rows. A mean is
/// 1 + d^2 / 24 - 17 d^4 / 5760 + ... with the second difference d^2, which takes each polynomial to the one before.
/// Derivation: with the derivative D the mean over a row is sinh(D / 2) / (D / 2) and d = 2 sinh(D / 2). For s = d / 2
/// the mean is s / arsinh(s) = 1 + s^2 / 6 - 17 s^4 / 360 + ..., which with s^2 = d^2 / 4 is the series above. As d^2
/// P_j = P_(j - 1), c_j becomes c_j + c_(j + 1) / 24 - 17 c_(j + 2) / 5760; j is at most 2, so the series ends there
/// and is exact.
void average_rows(double (&matrix)[3][3], int size) {
  for (int j = 0; j < size; ++j) {
    for (int a = 0; a < size; ++a) {
      if (j + 1 < size) matrix[j][a] += matrix[j + 1][a] / 24.0;
      if (j + 2 < size) matrix[j][a] -= matrix[j + 2][a] * 17.0 / 5760.0;
    }
  }
}

}  // namespace

bool StripWeights::serve(int size, int bands) noexcept {
  return bands >= kStripBands && size >= kSmallestFace && size % (2 * kStripRows) == 0 &&
         moments_for(size, bands) <= kMaxMoments;
}

// Interpolation at n zeros over a stretch of length L leaves 2 (w L / 4)^n / n! of a wave cos(w x). A harmonic of l <
// bands, divided by r^3, is as rough as a wave of w = bands (measured for three), so a face is as good as one of
// three bands that is smaller by as much.
int StripWeights::moments_for(int size, int bands) noexcept {
  // A row is 2 / N in u and w = 3, so the bound is 543 (6 / N)^4 / 4! = 2.7e-8 for 1024 (measured: 2.5e-8,
  // docs/maths/projection.md), 1907 (6 / N)^5 / 5! = 3.5e-9 for 512 and 6848 (6 / N)^6 / 6! = 1.6e-9 for 256. The last
  // two are measured as 8e-9 and 9e-9: a harmonic divided by r^3 is not one wave.
  const int alike = size * kStripBands / bands;
  return alike >= 1024 ? 4 : alike >= 512 ? 5 : alike >= kSmallestAlike ? 6 : kMaxMoments + 1;
}

StripWeights::StripWeights(int size, int bands, bool midpoint, const int* weight_rows)
    : size_(size), bands_(bands), midpoint_(midpoint), weight_rows_(weight_rows), rule_(weights_rule(size, bands)) {
  const int moments = moments_for(size, bands);
  const int pairs = moments / 2;
  const int evens = moments - pairs;
  matrix_.moments = moments;
  double even[3][3] = {};
  double odd[3][3] = {};
  for (int a = 0; a < evens; ++a) {
    const double* const zeros = kZeros[moments - kMinMoments];
    // zeros[0] goes to the outermost row's centre, 7.5 rows from the middle; an odd number of nodes has one at 0.
    const double x = a < pairs ? kOutermostRow * zeros[a] / zeros[0] : 0.0;
    rows_[a] = -x;
    rows_[moments - 1 - a] = x;
    for (int j = 0; j < evens; ++j) even[a][j] = even_polynomial(j, x);
    for (int j = 0; j < pairs && a < pairs; ++j) odd[a][j] = odd_polynomial(j, x);
  }
  // even[a][j] = P_j(x_a) is the matrix from coefficients to values at the nodes; its inverse takes values (the even
  // part of a pair) to coefficients, which are what the moments weigh.
  invert(even, evens);
  invert(odd, pairs);
  // Three bands and the midpoint rule have weights of whole texels at the nodes (an expansion of the integral, or the
  // value at the centre). Others are integrated along the columns only, at one v: they are values of a function of v
  // whose means over rows are wanted.
  if (!packed() && !midpoint) {
    average_rows(even, evens);
    average_rows(odd, pairs);
  }
  for (int j = 0; j < evens; ++j) {
    // A pair's mean is half its sum; the middle row is alone.
    double factors[3] = {};
    int counts[3] = {};
    for (int a = 0; a < evens; ++a) {
      counts[a] = a < pairs ? 2 : 1;
      factors[a] = even[j][a] / counts[a];
      matrix_.odd[j][a] = static_cast<float>(0.5 * odd[j][a]);
    }
    round_even(factors, counts, evens, j == 0 ? 1.0 : 0.0, matrix_.even[j]);
  }
}

std::size_t StripWeights::size(int columns) const noexcept {
  return static_cast<std::size_t>(functions() * moments() * (packed() ? 3 * columns : kChunk));
}

std::size_t StripWeights::scratch_size(int columns) const noexcept {
  return static_cast<std::size_t>(functions() * moments() * columns);
}

/// Weights of harmonics along the middle of a row, or over it where that is their expansion.
void StripWeights::fill_row(const image::TexelRun& run, float* weights) const noexcept {
  if (packed()) {
    image::texel_kernels().expand_texels(run, weight_rows_, weights, run.count);
  } else {
    image::texel_kernels().integrate_texels(run, math::basis_constants(), rule_, weight_rows_, weights, run.count);
  }
}

void StripWeights::fill(int strip, int first_column, int columns, float* weights, float* scratch) const noexcept {
  const int above_middle = strip * kStripRows + kStripRows / 2 - 1;
  for (int k = 0; k < moments(); ++k) {
    fill_row({size_, above_middle, first_column, columns, bands_, midpoint_, 0.5 + rows_[k], !packed() && !midpoint_},
             scratch + static_cast<std::ptrdiff_t>(functions()) * columns * k);
  }
  const int groups = columns / simd::kLanes;
  if (packed()) {
    strip_kernels().weigh_moments(matrix_, scratch, columns, groups, weights);
  } else {
    strip_kernels().weigh_planes(matrix_, scratch, columns, functions(), groups, weights);
  }
}

}  // namespace welkin::projection
