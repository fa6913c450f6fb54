// The cubic through four neighbouring nodes: how tables of a sky are read between them.
#pragma once

#include <algorithm>

namespace welkin::sky {

struct Cubic {
  int first = 0;
  double weights[4]{};
};

/// At a position among `count` nodes, 0 to count - 1. With less than four nodes: the curve through all of them, the
/// rest of the weights 0 (and of a node that is not there).
[[nodiscard]] inline Cubic cubic_at(double position, int count) noexcept {
  Cubic cubic;
  const double inside = std::min(std::max(position, 0.0), static_cast<double>(count - 1));
  const int nodes = std::min(count, 4);
  cubic.first = std::clamp(static_cast<int>(inside) - 1, 0, count - nodes);
  const double x = inside - cubic.first;
  for (int i = 0; i < nodes; ++i) {
    double weight = 1.0;
    for (int k = 0; k < nodes; ++k) {
      if (k != i) weight *= (x - k) / (i - k);
    }
    cubic.weights[i] = weight;
  }
  return cubic;
}

}  // namespace welkin::sky
