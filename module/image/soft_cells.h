// A row of cells along a line, with a value each, made smooth between neighbours without moving any of it.
//
// About each edge the value goes linearly from one cell's to the next one's, over a ramp of equal length on both sides;
// so the integral of a cell's share stays the cell's length, and all shares add up to 1. Ramps of no length: cells as
// they are; of a cell's length: linear interpolation between cells' centres, where cells are equal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace welkin::image {

class SoftCells {
 public:
  /// `edges`: rising, one more than there are cells. `half_ramps`: for each edge, at most half a neighbouring cell.
  SoftCells(std::vector<double> edges, std::vector<double> half_ramps);

  [[nodiscard]] int count() const noexcept { return static_cast<int>(edges_.size()) - 1; }

  /// The first cell that has a share beyond `place`, from `guess` on or before.
  [[nodiscard]] int first_beyond(double place, int guess) const noexcept;
  /// The last cell that has a share before `place`.
  [[nodiscard]] int last_before(double place, int guess) const noexcept;

  /// integrals[k] = the integral up to `place` of the shares of all cells from edge `first` + k on, k < number; so the
  /// integral of one cell's share is the difference of two. Edges beyond the last count as the last.
  void integrals_from_edges(double place, int first, int number, double* integrals) const noexcept {
    const auto begin = static_cast<std::size_t>(first);
    const int there = std::min(number, count() + 1 - first);
    for (int k = 0; k < there; ++k) {
      const std::size_t edge = begin + static_cast<std::size_t>(k);
      const double beyond = place - edges_[edge];
      const double half = half_ramps_[edge];
      // On the ramp (beyond + half)^2 / (4 half), and from its end on as much as lies beyond.
      const double on_ramp = std::min(std::max(beyond, -half), half) + half;
      integrals[k] = on_ramp * on_ramp * inverses_[edge] + std::max(beyond - half, 0.0);
    }
    for (int k = there; k < number; ++k) integrals[k] = integrals[k - 1];
  }

 private:
  std::vector<double> edges_;
  std::vector<double> half_ramps_;
  std::vector<double> inverses_;  ///< 1 / (4 half_ramps), or 0
};

}  // namespace welkin::image
