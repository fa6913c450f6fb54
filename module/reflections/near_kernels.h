// Kernels of near sums: what a lobe's near part has over each texel about 16 directions, and sums by such weights.
#pragma once

#include <cstddef>

#include "simd/dispatch.h"

namespace welkin::reflections {

/// The far part of a lobe 1 / (q + s)^2, s = sin^2(theta / 2), is P(x) / end^2, x = (q + s) / end, for x < 1, and all
/// of the lobe beyond: P(x) = Sum p_n (1 - x)^n meets 1 / x^2 there with its slope. The other coefficients leave the
/// least energy beyond the bands that a narrow lobe's far part takes, weighted by its taper: the root mean square left
/// out is 1.6e-4 of the far part's, and around a lone light no more than 0.9 % of the lobe is missing anywhere.
/// As 1 / x^2 = Sum (n + 1) (1 - x)^n, value and slope at x = 1 fix p_0 = 1 and p_1 = 2.
inline constexpr int kFarTerms = 6;
inline constexpr float kFarPart[kFarTerms] = {1.0F, 2.0F, 2.2343F, 4.6169F, -1.4649F, 3.9246F};

/// P(x), x from 0 to 1.
template <class Number>
[[nodiscard]] Number far_polynomial(Number x) {
  const Number y = Number(1.0F) - x;
  Number sum(kFarPart[kFarTerms - 1]);
  for (int n = kFarTerms - 2; n >= 0; --n) sum = sum * y + Number(kFarPart[n]);
  return sum;
}

/// A lobe split in two: 1 over the whole sphere, so much per steradian, but for the factor cos(theta).
struct SplitLobe {
  float width_squared;  ///< (2 alpha)^2: in the plane, the share within r is r^2 / (r^2 + width_squared)
  float offset;         ///< q = alpha^2 / (1 - alpha^2)
  float inverse_end;    ///< 1 / (q + s) where the near part ends
  float far_scale;      ///< of the far part P(x)
  bool fine;            ///< texels in the fine range take four by four points, else three by three
};

/// Some columns of a row, or corners of a line.
struct ColumnRange {
  int first;
  int end;  ///< one past the last
};

/// 16 directions (u, v, 1) in the frame of a cubemap face, and where they are in its texels.
struct CubeGroup {
  float u[simd::kLanes];
  float v[simd::kLanes];
  float column[simd::kLanes];  ///< whole
  float part[simd::kLanes];    ///< and the rest
  float row[simd::kLanes];
  float part_row[simd::kLanes];
  float size;  ///< texels along an edge
};

/// 16 directions over a lat-long.
struct LatLongGroup {
  float sine[simd::kLanes];  ///< of the latitude
  float cosine[simd::kLanes];
  float sine_of_part[simd::kLanes];  ///< of half the angle from the direction's own column's line
  float cosine_of_part[simd::kLanes];
  float sine_of_middle[simd::kLanes];  ///< and from that column's middle
  float cosine_of_middle[simd::kLanes];
  float row[simd::kLanes];       ///< whole
  float part_row[simd::kLanes];  ///< and the rest
  float rows;
  float down;            ///< radians of a row
  float across;          ///< and of a column
  const float* columns;  ///< sine and cosine of half the angle of `column` columns; any that corners need
};

/// A line of texels' corners, [count][16] each, in the plane that touches the sphere at a lobe's direction, r = 2
/// tan(theta / 2) (stereographic): positions (x with the columns, y with the rows), and what the edge from each corner
/// to the next takes of the lobe (count - 1 of them).
struct CornerLine {
  float* x;
  float* y;
  float* edge;
  float* bend;  ///< [16], of a lat-long: the line's curvature, above 0 where its middle lies at larger y. Else null
};

/// Fills a line for those corners (of a lat-long its bend too); corners beyond the edges of the face, or the poles, are
/// moved to them. `row`, `corners`: whole texels from the direction's own. In a lat-long corner 1 is at the direction's
/// own meridian, and corner i > 1 is where column i - 1 begins: a parallel is bent where the lobe is cut by it.
template <class Group>
using MeasureLine = void (*)(const SplitLobe& lobe, const Group& group, int row, ColumnRange corners,
                             const CornerLine& line);

/// The columns of a row that some lobes reach. Each range lies within the one before.
struct RowRange {
  ColumnRange columns;  ///< those beyond the fine ones take two by two Gauss points
  ColumnRange fine;     ///< more
  ColumnRange close;    ///< integrated in closed form
};

/// Writes the near part's share of a row's texels to [][16]: of texels that are close between two lines that were
/// measured there, of others by Gauss points. Texels that do not exist have none.
template <class Group>
using WeighRow = void (*)(const SplitLobe& lobe, const Group& group, int row, const RowRange& range,
                          const CornerLine& above, const CornerLine& below, float* weights);

/// Texels of a row that follow each other.
struct NearRun {
  int row;  ///< of all parts of the source
  int first;
  int count;
};

/// Runs of records, and their weights one after the other.
struct NearTaps {
  const float* records;
  const std::ptrdiff_t* rows;  ///< where each row's column 0 is, or would be, among the records, floats
  const NearRun* runs;
  int count;
  const float* weights;
};

/// Writes the sum of weight times record to `sums`, [kRecordFloats], aligned. Returns where the weights end.
using SumRuns = const float* (*)(const NearTaps& taps, float* sums);

template <class Group>
struct GroupKernels {
  MeasureLine<Group> measure;
  WeighRow<Group> weigh;
};

struct NearKernels {
  GroupKernels<CubeGroup> cube;
  GroupKernels<LatLongGroup> lat_long;

  /// Scales each direction's weights, [texels][16], to a sum of its own.
  void (*scale)(float* weights, int texels, const float* sums);
  SumRuns sum_runs;
};
WELKIN_KERNEL_TABLES(NearKernels, near_kernels)

}  // namespace welkin::reflections
