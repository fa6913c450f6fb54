// Weights of a face that is averaged by solid angle into target x target cells first.
//
// The average is linear, so it needs no pass of its own: with W the solid angle of a piece of a texel, a
// cell's mean radiance is sum L W(piece) / W(cell), and the cell then weighs Int Y over it. Together a texel
// weighs
//
//   sum over the cells it touches of  W(piece) / W(cell) Int_cell Y,
//
// at any ratio of sizes, and the projection reads it like any other weight.
#include <algorithm>
#include <cstdint>

#include "tables/solid_angle.h"
#include "tables/texel_weights.h"

namespace welkin::tables {
namespace {

using simd::kChunk;
using simd::kLanes;

constexpr int kTargetStride = kChunk + kLanes;  // a chunk's columns touch at most kChunk + 1 cells
constexpr double kY00 = 0.28209479177387814;    // sqrt(1 / 4 pi)

/// A stretch of a texel's extent that lies in one cell, in texels from the face's edge.
struct Piece {
  double begin;
  double end;
  int cell;
};

struct Pieces {
  int count;
  Piece piece[2];
};

/// The one or two cells that texel [index, index + 1) overlaps; cells are size / target texels wide.
Pieces cut_texel(int index, int size, int target) {
  const std::int64_t n = size;
  const std::int64_t t = target;
  const std::int64_t cell = index * t / n;
  const std::int64_t boundary = (cell + 1) * n;  // in 1/target of a texel
  const auto first = static_cast<int>(cell);
  if (boundary >= (index + std::int64_t{1}) * t) return {1, {{static_cast<double>(index), index + 1.0, first}, {}}};
  const double cut = static_cast<double>(boundary) / static_cast<double>(target);
  return {2, {{static_cast<double>(index), cut, first}, {cut, index + 1.0, first + 1}}};
}

/// Solid angle of a rectangle of texels on the face, by a Gauss rule.
double solid_angle(const Piece& columns, const Piece& rows, int size, const simd::GaussRule& rule) {
  const double h = 1.0 / static_cast<double>(size);
  const double u_half = h * (columns.end - columns.begin);
  const double v_half = h * (rows.end - rows.begin);
  const double u_centre = h * (columns.begin + columns.end) - 1.0;
  const double v_centre = h * (rows.begin + rows.end) - 1.0;
  return rectangle_solid_angle(u_centre, v_centre, u_half, v_half, rule);
}

/// A cell beyond the middle is the mirror image of one in the quadrant: odd functions change sign.
struct QuadrantCell {
  int index;
  bool mirrored;
};

QuadrantCell in_quadrant(int cell, int target) {
  const int half = (target + 1) / 2;
  return cell < half ? QuadrantCell{cell, false} : QuadrantCell{target - 1 - cell, true};
}

/// weights[f] += share x cell[f], with the signs of a mirrored cell.
void add_share(float share, const float* cell, bool mirrored_in_u, bool mirrored_in_v, const simd::ClassCounts& counts,
               float* weights) {
  int f = 0;
  for (int symmetry = 0; symmetry < simd::kMaximumClasses; ++symmetry) {
    const bool odd_in_u = symmetry == 1 || symmetry == 3;
    const bool odd_in_v = symmetry >= 2;
    const bool negative = (mirrored_in_u && odd_in_u) != (mirrored_in_v && odd_in_v);
    const float signed_share = negative ? -share : share;
    for (int i = 0; i < counts.count[symmetry]; ++i, ++f) {
      weights[f * kChunk] += signed_share * cell[f * kTargetStride];
    }
  }
}

}  // namespace

void TexelWeights::fill_reduced_row(int row, int first_column, int count, float* weights, float* scratch) const {
  const int functions = key_.bands * key_.bands;
  const int target = key_.target_size;
  const simd::GaussRule rule = texel_rule(key_.size);
  float* const whole_texels = scratch + functions * kTargetStride;  // solid angle times Y00, of the whole row
  fill_run({key_.size, row, first_column, count, 1, key_.midpoint}, whole_texels, kTargetStride);

  const int padded = (count + kLanes - 1) / kLanes * kLanes;
  for (int f = 0; f < functions; ++f) std::fill_n(weights + f * kChunk, padded, 0.0F);

  const int first_cell = in_quadrant(cut_texel(first_column, key_.size, target).piece[0].cell, target).index;
  const Pieces last = cut_texel(first_column + count - 1, key_.size, target);
  const int end_cell = std::min(last.piece[last.count - 1].cell + 1, (target + 1) / 2);
  const Pieces rows = cut_texel(row, key_.size, target);
  for (int r = 0; r < rows.count; ++r) {
    const QuadrantCell cell_row = in_quadrant(rows.piece[r].cell, target);
    target_->copy_row(cell_row.index, first_cell, end_cell - first_cell, scratch, kTargetStride);
    for (int k = 0; k < count; ++k) {
      const Pieces columns = cut_texel(first_column + k, key_.size, target);
      for (int c = 0; c < columns.count; ++c) {
        const QuadrantCell cell_column = in_quadrant(columns.piece[c].cell, target);
        const float* const cell = scratch + (cell_column.index - first_cell);
        const bool whole = rows.count == 1 && columns.count == 1;
        const double piece = whole ? static_cast<double>(whole_texels[k])
                                   : kY00 * solid_angle(columns.piece[c], rows.piece[r], key_.size, rule);
        add_share(static_cast<float>(piece / static_cast<double>(cell[0])), cell, cell_column.mirrored,
                  cell_row.mirrored, counts_, weights + k);
      }
    }
  }
}

}  // namespace welkin::tables
