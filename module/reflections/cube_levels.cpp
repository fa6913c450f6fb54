#include "reflections/cube_levels.h"

#include <algorithm>

namespace welkin::reflections {

std::vector<CubeLevel> cube_levels(int face_size) {
  constexpr int kLeastSize = 4;
  std::vector<CubeLevel> levels{{face_size, 0}};
  for (int size = face_size; size % 2 == 0 && size > kLeastSize; size /= 2) {
    // what lies a margin beyond goes to points up to one and a half of the coarser steps further
    levels.push_back({size / 2, levels.size() == 1 ? 2 : 3});
  }
  return levels;
}

std::size_t coarsening_floats(const CubeLevel& finer, const CubeLevel& coarser) noexcept {
  return std::size_t{3} * static_cast<std::size_t>(finer.edge()) * static_cast<std::size_t>(coarser.edge());
}

namespace {

/// The finer points that give to a coarser one: eight from `first` on, of which those from `from` up to `end` exist.
struct Givers {
  Givers(const CubeLevel& finer, const CubeLevel& coarser, int index) noexcept
      : first(2 * (index - coarser.margin) - 3 + finer.margin),
        from(std::max(0, -first)),
        end(std::min(8, finer.edge() - first)) {}
  int first;
  int from;
  int end;
};

constexpr std::array<float, 8> kGiven{-5.0F / 128.0F,  -7.0F / 128.0F, 35.0F / 128.0F, 105.0F / 128.0F,
                                      105.0F / 128.0F, 35.0F / 128.0F, -7.0F / 128.0F, -5.0F / 128.0F};

}  // namespace

void coarsen(const CubeLevel& finer, const float* from, const CubeLevel& coarser, float* to, float* room) noexcept {
  const std::ptrdiff_t row_floats = std::ptrdiff_t{3} * finer.edge();
  for (int row = 0; row < coarser.edge(); ++row) {
    const Givers givers(finer, coarser, row);
    float* const sums = room + row * row_floats;
    std::fill_n(sums, row_floats, 0.0F);
    for (int k = givers.from; k < givers.end; ++k) {
      const float* const line = from + (givers.first + k) * row_floats;
      const float share = kGiven[static_cast<std::size_t>(k)];
      for (std::ptrdiff_t i = 0; i < row_floats; ++i) sums[i] += share * line[i];
    }
  }
  for (int row = 0; row < coarser.edge(); ++row) {
    const float* const line = room + row * row_floats;
    for (int column = 0; column < coarser.edge(); ++column, to += 3) {
      const Givers givers(finer, coarser, column);
      std::array<float, 3> sum{};
      for (int k = givers.from; k < givers.end; ++k) {
        const float* const point = line + std::ptrdiff_t{3} * (givers.first + k);
        const float share = kGiven[static_cast<std::size_t>(k)];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += share * point[c];
      }
      std::copy(sum.begin(), sum.end(), to);
    }
  }
}

}  // namespace welkin::reflections
