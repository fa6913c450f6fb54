// The kernels of narrow lobes: how much of each lobe falls on each texel near by. A group is 16 lobes side by side.
#pragma once

#include <cstddef>

#include "simd/dispatch.h"

namespace welkin::reflections {

/// A lobe in the plane that touches the sphere at its direction, r = 2 tan(theta / 2) (stereographic), split in two:
/// 1 / (q + s)^2 = near + far, s = sin^2(theta / 2), near = (1 + u) e^-u / (q + s)^2, u = split (q + s).
struct SplitLobe {
  float width_squared;  ///< (2 alpha)^2: the share within r is r^2 / (r^2 + width_squared)
  float offset;         ///< split q, q = alpha^2 / (1 - alpha^2)
  float split;
  float far_scale;  ///< of (1 - (1 + u) e^-u) / u^2, so that it is the far part's share of a texel, a steradian
};

/// A line of texels' corners, [count][16] each: places in the plane (x with the columns, y with the rows), the far
/// part's density there, and what the edge from each corner to the next takes of the lobe (count - 1 of them).
struct CornerLine {
  float* x;
  float* y;
  float* far;
  float* edge;
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

/// Fills x and y for the corners of a line; corners beyond the edges of the face are moved to them. `row`,
/// `first_column`: whole texels from the direction's own.
using PlaceCube = void (*)(const CubeGroup& group, int first_column, int row, int count, const CornerLine& line);

/// Some columns of a row.
struct ColumnRange {
  int first;
  int end;  ///< one past the last
};

/// Fills `far` of the corners and `edge` of the edges of those texels, in a line whose places are known.
using MeasureLine = void (*)(const SplitLobe& lobe, ColumnRange columns, const CornerLine& line);

/// Writes to those texels' entries of [][16] their share of the near part, between two lines that were measured there,
/// and adds them up to `sums`, [16]. The lobe's factor 1 - 2 s is in them.
/// `weigh_far`: by the lobe's series about the texel's centre, relative error 4e-3 two texels away, 1e-3 at two and a
/// half, falling like the sixth power; the lines need not be measured.
using WeighRow = void (*)(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, ColumnRange columns,
                          float* weights, float* sums);

/// sum += weight times texel, for `count` packed RGB texels; weights are 16 floats apart. `sum`: four floats, aligned.
using AddTexels = void (*)(const float* rgb, const float* weights, int count, float* sum);

struct NarrowKernels {
  PlaceCube place_cube;
  MeasureLine measure_line;
  WeighRow weigh_close;
  WeighRow weigh_far;
  AddTexels add_texels;
};
WELKIN_KERNEL_TABLES(NarrowKernels, narrow_kernels)

}  // namespace welkin::reflections
