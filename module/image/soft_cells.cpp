#include "image/soft_cells.h"

#include <algorithm>
#include <utility>

namespace welkin::image {

SoftCells::SoftCells(std::vector<double> edges, std::vector<double> half_ramps)
    : edges_(std::move(edges)), half_ramps_(std::move(half_ramps)) {
  for (const double half : half_ramps_) inverses_.push_back(half > 0.0 ? 1.0 / (4.0 * half) : 0.0);
}

int SoftCells::first_beyond(double place, int guess) const noexcept {
  const auto ends_beyond = [&](int cell) {
    const auto end = static_cast<std::size_t>(cell + 1);
    return edges_[end] + half_ramps_[end] > place;
  };
  int cell = std::clamp(guess, 0, count() - 1);
  while (cell > 0 && ends_beyond(cell - 1)) --cell;
  while (cell < count() - 1 && !ends_beyond(cell)) ++cell;
  return cell;
}

int SoftCells::last_before(double place, int guess) const noexcept {
  const auto begins_before = [&](int cell) {
    const auto begin = static_cast<std::size_t>(cell);
    return edges_[begin] - half_ramps_[begin] < place;
  };
  int cell = std::clamp(guess, 0, count() - 1);
  while (cell < count() - 1 && begins_before(cell + 1)) ++cell;
  while (cell > 0 && !begins_before(cell)) --cell;
  return cell;
}

}  // namespace welkin::image
