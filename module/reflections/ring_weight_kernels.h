// Kernels that make the weights of a `RingTable`.
#pragma once

#include <cstddef>
#include <cstdint>

#include "platform/compiler.h"
#include "reflections/ring_kernels.h"
#include "simd/dispatch.h"

namespace welkin::reflections {

/// Cells, of rings or of columns, that share the light of a point; lanes that hold them; powers of the polynomials.
inline constexpr int kSpread = 5;
inline constexpr int kShareLanes = 8;
inline constexpr int kSharePowers = 13;
/// Gauss points in a part of a texel's edge.
inline constexpr int kPartPoints = 2;

/// values[i][k] = the polynomial of cell cells[i] and neighbour k at places[i]. `coefficients`:
/// [cell][power][neighbour], the highest power first.
using EvaluateShares = void (*)(const float* coefficients, const int* cells, const float* places, int count,
                                float* values);

/// A line of texels' edges, each cut into parts with `kPartPoints` points.
struct RingEdges {
  const std::uint32_t* parts;  ///< [edge + 1]: edge k has the parts from parts[k] up to parts[k + 1]
  const int* columns;          ///< [part]: the first of `kShareLanes` columns
  const float* across;         ///< [part][point][lane]: what falls on these columns of the point's longitudes
  const int* rings;            ///< [part][point]: the ring that the point lies on
  const float* along;          ///< [part][point][lane]: shares of the rings from `rings` - 2 on, from the pole to there
};

/// What reaches columns of the longitudes of edges' parts.
struct ColumnShares {
  const int* end_columns;     ///< [part][end]
  const float* end_shares;    ///< [part][end][lane]: of the columns from `end_columns` - 2 on, integrated up to there
  const int* point_columns;   ///< [part][point]
  const float* point_shares;  ///< [part][point][lane]
  const float* widths;        ///< [part][point]: columns that the point stands for
  int count;                  ///< parts
  bool falling;               ///< longitudes fall from a part's first end to its second one
};

/// The points' shares times widths, moved to a part's columns and made to add up to what the ends say.
using ShareColumns = void (*)(const ColumnShares& shares, int* columns, float* across);

/// Rings and columns that a texel's light reaches; a ring below 0 lies beyond the pole.
struct RingWindow {
  int first_ring;
  int rings;
  int first_column;
  int columns;
};

/// One edge of a texel: the parts from `first` up to `end`; inner ones lie towards the pole.
struct TexelEdge {
  const RingEdges* line;
  std::uint32_t first;
  std::uint32_t end;
  bool inner;
};

struct WeighedTexel {
  RingWindow window;
  int clip_first;  ///< rings that are wanted
  int clip_end;
  TexelEdge edges[4];
  int edge_count;
  std::uint32_t record;
  std::uint32_t images;       ///< bit k: image k has a record of its own, as some cells lie outside the sixteenth
  std::uint32_t first_image;  ///< record of the first of them
};

/// Columns of a ring of the sixteenth, and which image brings texels around it there.
struct RingCells {
  int ring;
  int column;  ///< of the first one
  int step;    ///< from one to the next: 1, or -1 in a mirror image
  int count;
  int image;
};

/// Calls `take(cells, k)` for the parts of `columns` columns of a ring from `first` on that lie in one sixteenth each,
/// k columns further on. `first` is above -8 `width`.
template <class Take>
WELKIN_INLINE void for_folded(int ring, int first, int columns, int rows, int width, const Take& take) {
  if (ring < 0) {
    ring = -1 - ring;
    first += 4 * width;
  }
  const bool below = ring >= rows / 2;
  if (below) ring = rows - 1 - ring;
  first += 8 * width;
  int eighth = first / width;
  int column = first - eighth * width;
  for (int k = 0; k < columns; ++eighth, column = 0) {
    const bool mirrored = eighth % 2 == 1;
    const int count = columns - k < width - column ? columns - k : width - column;
    const int image = 4 * ((eighth + 1) / 2 % 4) + (mirrored ? 2 : 0) + (below ? 1 : 0);
    take(RingCells{ring, mirrored ? width - 1 - column : column, mirrored ? -1 : 1, count, image}, k);
    k += count;
  }
}

/// Where the taps of a band's rings go.
struct RingBand {
  const float* whole;   ///< [ring + 2]: what a ring gets where all of it is passed
  int rows;             ///< of the whole sphere
  int first_ring;       ///< of the band
  int width;            ///< columns of the sixteenth
  std::uint32_t* next;  ///< [ring][column]: where the next tap goes
  RingTap* taps;
};

/// Finds a texel's weights and writes them. `block`: zeros, rings x (columns + `kShareLanes`) of the
/// window, and as many again as there are lanes; left so.
using WeighTexel = void (*)(const WeighedTexel& texel, const RingBand& band, float* block);

struct RingWeightKernels {
  EvaluateShares evaluate_shares;
  ShareColumns share_columns;
  WeighTexel weigh_texel;
};
WELKIN_KERNEL_TABLES(RingWeightKernels, ring_weight_kernels)

}  // namespace welkin::reflections
