// Sums of Gaussians over the texels of a lat-long: how much of each falls on each texel near by. A group is 16
// directions side by side.
#pragma once

#include <cstddef>

#include "simd/dispatch.h"

namespace welkin::reflections {

/// Gaussians e^(-t s), s = sin^2(theta / 2): what `narrow.h` calls the near part is a sum of some.
struct GaussianLobe {
  static constexpr int kMost = 32;

  int count;
  float root[kMost];    ///< sqrt(t) / 2
  float weight[kMost];  ///< of the Gaussian's integral over the sphere, a quarter of it
};

/// Texels that a Gaussian reaches: rows to either side of the direction's own (none: it lies in that one); columns to
/// either side of the next line between two, or near a pole of the direction's own.
struct GaussianReach {
  int rows[GaussianLobe::kMost];
  int columns[GaussianLobe::kMost];
};

/// 16 directions on a lat-long's grid.
struct GaussianGroup {
  float from_line[simd::kLanes];  ///< columns from the next line between two, -1/2 to 1/2
  float part_row[simd::kLanes];   ///< of the place within its texel, 0 to 1
  float across[simd::kLanes];     ///< width of a column at the direction's latitude, radians
  float tangent[simd::kLanes];    ///< of its latitude
  float down;                     ///< height of a row, radians
};

/// Writes each texel's share, [2 rows + 1][2 columns][16], and adds up all. `rows`, `columns`: the largest of
/// `reach`. `lines`: room for 64 (rows + columns + 1) floats.
///
/// A Gaussian is the product of a row's share and a column's. Meridians converge: with the row's latitude at a distance
/// d, s = sin^2(d / 2) + cos cos' sin^2(dlambda / 2), so that a column is sqrt(cos' / cos) as wide as it is in the
/// direction's own row. The share changes with that to first order, which errs by its square: rows must lie well away
/// from the poles.
using WeighGaussians = void (*)(const GaussianLobe& lobe, const GaussianReach& reach, const GaussianGroup& group,
                                int rows, int columns, float* lines, float* weights, float* sums);

/// The same near a pole, where shares are found without that approximation, at any distance from the pole.
struct PolarGroup {
  float sine_of_part[simd::kLanes];  ///< of half the angle from the column's first line to the place, in longitude
  float cosine_of_part[simd::kLanes];
  float part_row[simd::kLanes];  ///< of the place within its texel, 0 to 1
  float row[simd::kLanes];       ///< that texel's
  float sine_latitude[simd::kLanes];
  float cosine_latitude[simd::kLanes];
  float down;        ///< height of a row, radians
  float rows;        ///< of the grid
  int divided;       ///< parts of a row that are summed by themselves
  int column_parts;  ///< the same of a column
};

/// Columns of a window.
struct PolarWindow {
  int rows;   ///< to either side
  int first;  ///< column from the direction's own
  int columns;
  const int* sides;  ///< of each row: columns to either side that count, or more than there are
};
struct ColumnsOfRow {
  int first;
  int end;  ///< one past the last
};
[[nodiscard]] constexpr ColumnsOfRow columns_of_row(const PolarWindow& window, int row) noexcept {
  const int before = -window.sides[row] - window.first;
  const int end = window.sides[row] + 1 - window.first;
  return {before < 0 ? 0 : before, end < window.columns ? end : window.columns};
}

/// As `WeighGaussians`, [2 rows + 1][columns][16], of each row what counts. Rows beyond the poles have no weight.
/// `columns`: [window.columns * column_parts + 1][2] sines and cosines of half the angles that the lines between
/// columns' parts are from the direction's own column.
using WeighPolar = void (*)(const GaussianLobe& lobe, const GaussianReach& reach, const PolarGroup& group,
                            const PolarWindow& window, const float* columns, float* lines, float* weights, float* sums);

// Windows of texels with their weights are summed for one direction at a time, eight columns side by side: 24 floats of
// packed RGB, times weights that stand there three times each. Columns beyond a window's last one have no weight.

/// Floats of a sum: its places have red, green and blue by turns.
inline constexpr int kWindowFloats = 24;

/// Weights, [rows][columns][16], for each of the 16 directions as `add_windows` wants them: [16][`spread_floats`], of
/// those [rows][columns, whole eights][3]. `mirrored`: the last column first. `plain`: [16][`spread_floats` / 3].
using SpreadWeights = void (*)(const float* weights, int rows, int columns, bool mirrored, float* plain, float* spread);
/// The same near a pole, for one direction, whose weights are 16 floats apart: [rows][columns][3], what counts.
using SpreadLane = void (*)(const float* weights, const PolarWindow& window, bool mirrored, float* spread);

/// Floats from a direction's spread weights to the next one's.
[[nodiscard]] constexpr std::ptrdiff_t spread_floats(int rows, int columns) noexcept {
  return std::ptrdiff_t{3} * ((rows * ((columns + 7) / 8 * 8) + 31) / 16 * 16);
}

/// Rows of packed RGB: texel 0 of each is at first[0], first[step], ...
struct WindowRows {
  const float* const* first;
  int step;
  int count;
  int eights;  ///< of columns
};

/// sums[k] = weights times the texels from `offsets[k]` floats on in each row, for up to four windows of the same rows
/// and weights. Whole eights of columns are read.
using AddWindows = void (*)(const WindowRows& rows, const std::ptrdiff_t* offsets, int windows, const float* weights,
                            float (*sums)[kWindowFloats]);

/// sums += weights times `count` texels side by side; no more are read.
using AddRun = void (*)(const float* texels, const float* weights, int count, float* sums);

/// rgb[k] += scale[k] times the light of sums[k], and no less than `least`. A float beyond the last sum must be
/// readable.
using FoldSums = void (*)(const float (*sums)[kWindowFloats], int count, const float* scale, float least,
                          float* const* rgb);

struct GaussianKernels {
  WeighGaussians weigh;
  WeighPolar weigh_polar;
  SpreadWeights spread;
  SpreadLane spread_lane;
  AddWindows add_windows;
  AddRun add_run;
  FoldSums fold;
};
WELKIN_KERNEL_TABLES(GaussianKernels, gaussian_kernels)

}  // namespace welkin::reflections
