// How a point's light goes to the rings and columns about it.
#pragma once

#include <vector>

namespace welkin::reflections {

/// Polynomials of the shares that the `kSpread` cells about a point have of its light: along both axes in such shares
/// that the moments below `kSpread` - 1 are the point's own (about the poles nearly so: uniform light is uniform
/// there). They pass smoothly from one `kSpread` - 1 neighbours to the next ones. All are [cell][power][lane],
/// `kSharePowers` and `kShareLanes`, the highest power first, of the place from the cell's middle; lane k stands for
/// the cell k - `kSpread` / 2 further on.
struct RingShares {
  /// `rows`: rings from pole to pole; twice as many columns.
  explicit RingShares(int rows);

  std::vector<float> columns;         ///< one cell: shares of the columns
  std::vector<float> columns_before;  ///< one cell: their integrals, in columns, from before all of them to the place
  /// Cells 0 to rows / 2: shares of the rings over the ring's area, integrated over the sphere from the pole to the
  /// place. Rings go on beyond the pole.
  std::vector<float> rings_before;
  std::vector<float> whole;  ///< of ring k - 2, to rows / 2 + 2: the same integral over all places
};

}  // namespace welkin::reflections
