#include "image/sphere_grid.h"

#include <cstring>

namespace welkin::image {
namespace {

constexpr std::size_t kTexelBytes = 4 * sizeof(float);

float mean(float a, float b) noexcept { return 0.5F * a + 0.5F * b; }

}  // namespace

void SphereGrid::fill_sides(int first, int count) noexcept {
  for (int ring = first; ring < first + count; ++ring) {
    for (int k = 0; k < kBorder; ++k) {  // one by one: a ring may have fewer texels than the border
      const int wrapped_left = ((columns_ - 1 - k) % columns_ + columns_) % columns_;
      std::memcpy(texel(-1 - k, ring), texel(wrapped_left, ring), kTexelBytes);
      std::memcpy(texel(columns_ + k, ring), texel(k % columns_, ring), kTexelBytes);
    }
  }
}

void SphereGrid::fill_poles() noexcept {
  const int half_turn = columns_ / 2;
  for (int beyond = 1; beyond <= kBorder; ++beyond) {
    const int distance = (beyond - 1) % (2 * rings_);  // over one pole, and with few rings over the other one too
    const bool over_both = distance >= rings_;
    const int top_source = over_both ? 2 * rings_ - 1 - distance : distance;
    const int bottom_source = rings_ - 1 - top_source;
    for (int column = 0; column < columns_; ++column) {
      const int from = over_both ? column : (column + half_turn) % columns_;
      const int next = over_both || columns_ % 2 == 0 ? from : (from + 1) % columns_;
      for (int c = 0; c < 4; ++c) {
        texel(column, -beyond)[c] = mean(texel(from, top_source)[c], texel(next, top_source)[c]);
        texel(column, rings_ - 1 + beyond)[c] = mean(texel(from, bottom_source)[c], texel(next, bottom_source)[c]);
      }
    }
    fill_sides(-beyond, 1);
    fill_sides(rings_ - 1 + beyond, 1);
  }
}

}  // namespace welkin::image
