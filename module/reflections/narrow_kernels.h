// The kernels of narrow lobes: how much of each lobe falls on each texel near by. A group is 16 lobes side by side.
#pragma once

#include "simd/dispatch.h"

namespace welkin::reflections {

/// The far part of a lobe 1 / (q + s)^2, s = sin^2(theta / 2), is P(x) / end^2, x = (q + s) / end, for x < 1, and all
/// of the lobe beyond: P(x) = Sum p_n (1 - x)^n meets 1 / x^2 there with its slope. The other coefficients leave the
/// least energy beyond the bands that a `NarrowSplit` takes, weighed by its taper: the root mean square left out is
/// 1.6e-4 of the far part's, and beside a lone light no more than 0.9 % of the lobe is missing anywhere.
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

/// A lobe split in two: 1 over the whole sphere, so much per steradian.
struct SplitLobe {
  float width_squared;  ///< (2 alpha)^2: in the plane, the share within r is r^2 / (r^2 + width_squared)
  float offset;         ///< q = alpha^2 / (1 - alpha^2)
  float inverse_end;    ///< 1 / (q + s) where the near part ends
  float scale;          ///< of the lobe 1 / (q + s)^2
  float far_scale;      ///< of the far part P(x)
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

/// Fills a line for those corners (of a lat-long its bend too); corners beyond the edges of the face, or the poles, are
/// moved to them. `row`, `corners`: whole texels from the direction's own. In a lat-long corner 1 is at the direction's
/// own meridian, and corner i > 1 is where column i - 1 begins: a parallel is bent where the lobe is cut by it.
template <class Group>
using MeasureLine = void (*)(const SplitLobe& lobe, const Group& group, int row, ColumnRange corners,
                             const CornerLine& line);

/// The columns of a row that some lobes reach.
struct RowRange {
  ColumnRange columns;
  ColumnRange close;  ///< those that are integrated in closed form
  bool beside_pole;   ///< of a lat-long: a texel's width changes from its top to its bottom
};

/// Writes the near part's share of a row's texels to [][16], and adds them up to `sums`, [16]; of texels that are close
/// between two lines that were measured there, of others by the lobe's series about the texel's centroid: relative
/// error 4e-3 two texels away, 1e-3 at two and a half, falling like the sixth power. Beside a pole those are integrated
/// by three by three Gauss points.
template <class Group>
using WeighRow = void (*)(const SplitLobe& lobe, const Group& group, int row, const RowRange& range,
                          const CornerLine& above, const CornerLine& below, float* weights, float* sums);

inline constexpr int kImages = 16;  ///< of each texel, see `TexelImages`
inline constexpr int kImageFloats = 3 * kImages;

/// Texels that lie one after the other, [count][kImageFloats], and their weights, 16 floats apart.
struct TexelRun {
  const float* texels;
  const float* weights;
  int count;
};

/// Writes the sum of weight times texel to `sums`, [kImageFloats], aligned.
using SumRuns = void (*)(const TexelRun* runs, int count, float* sums);

struct NarrowKernels {
  MeasureLine<CubeGroup> measure_cube;
  MeasureLine<LatLongGroup> measure_lat_long;
  WeighRow<CubeGroup> weigh_cube;
  WeighRow<LatLongGroup> weigh_lat_long;
  SumRuns sum_runs;
};
WELKIN_KERNEL_TABLES(NarrowKernels, narrow_kernels)

}  // namespace welkin::reflections
