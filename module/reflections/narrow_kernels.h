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

/// A lobe in the plane that touches the sphere at its direction, r = 2 tan(theta / 2) (stereographic), split in two.
struct SplitLobe {
  float width_squared;  ///< (2 alpha)^2: the share within r is r^2 / (r^2 + width_squared)
  float offset;         ///< q = alpha^2 / (1 - alpha^2)
  float inverse_end;    ///< 1 / (q + s) where the near part ends
  float far_scale;      ///< of P(x), so that it is a density per steradian where the lobe's is 1 over the whole sphere
};

/// A line of texels' corners, [count][16] each: positions in the plane (x with the columns, y with the rows), the far
/// part's density there per unit of the plane, and what the edge from each corner to the next takes of the lobe
/// (count - 1 of them).
struct CornerLine {
  float* x;
  float* y;
  float* far;
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
  float row[simd::kLanes];       ///< whole
  float part_row[simd::kLanes];  ///< and the rest
  float rows;
  float down;            ///< radians of a row
  const float* columns;  ///< sine and cosine of half the angle of `column` columns; any that corners need
};

/// Fills x and y for the corners of a line (and of a lat-long its bend); corners beyond the edges of the face, or the
/// poles, are moved to them. `row`, `corners`: whole texels from the direction's own. In a lat-long corner 1 is at the
/// direction's own meridian, and corner i > 1 is where column i - 1 begins: a parallel is bent where the lobe is cut by
/// it.
using PlaceCube = void (*)(const CubeGroup& group, int row, ColumnRange corners, const CornerLine& line);
using PlaceLatLong = void (*)(const LatLongGroup& group, int row, ColumnRange corners, const CornerLine& line);

/// Fills `far` of corners whose positions are known.
using MeasureCorners = void (*)(const SplitLobe& lobe, ColumnRange corners, const CornerLine& line);
/// Fills `edge` of those texels' edges.
using MeasureEdges = void (*)(const SplitLobe& lobe, ColumnRange columns, const CornerLine& line);

/// Writes to those texels' entries of [][16] their share of the near part, between two lines that were measured there,
/// and adds them up to `sums`, [16]. `weigh_close`: with the lobe's share in closed form. `weigh_far`: by the lobe's
/// series about the texel's centre, relative error 4e-3 two texels away, 1e-3 at two and a half, falling like the sixth
/// power.
using WeighRow = void (*)(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, ColumnRange columns,
                          float* weights, float* sums);

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
  PlaceCube place_cube;
  PlaceLatLong place_lat_long;
  MeasureCorners measure_corners;
  MeasureEdges measure_edges;
  WeighRow weigh_close;
  WeighRow weigh_far;
  SumRuns sum_runs;
};
WELKIN_KERNEL_TABLES(NarrowKernels, narrow_kernels)

}  // namespace welkin::reflections
