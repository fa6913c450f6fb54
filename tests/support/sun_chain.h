// A sky whose light is mostly a sun's, as blocks of a few texels find it hardest to hold.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "support/chains.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::test {

/// Noise of 0.5 to 1, and a coloured disc three texels wide that reaches 50 000.
inline Cubemap sun_chain(int size) {
  Cubemap sky(size, 1);
  std::uint32_t state = 7;
  for (int k = 0; k < 18 * size * size; ++k) {
    state = 1664525U * state + 1013904223U;
    sky.face(0, 0)[k] = 0.5F + 0.5F * static_cast<float>(state >> 8U) / 16777216.0F;
  }
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const float x = static_cast<float>(column - size / 2) - 0.3F;
      const float y = static_cast<float>(row - size / 2) + 0.6F;
      float* const rgb = sky.face(0, 2) + std::ptrdiff_t{3} * (row * size + column);
      const float light = 50000.0F / (1.0F + (x * x + y * y) * (x * x + y * y));
      rgb[0] += light;
      rgb[1] += light * (0.55F + 0.07F * x);
      rgb[2] += light * (0.21F - 0.03F * y);
    }
  }
  return build_mips(sky.view(0));
}

/// The most that a channel's mean over a level is off.
inline double largest_bias(const Cubemap& decoded, const Cubemap& given, int level) {
  std::array<double, 3> sums{};
  std::array<double, 3> wanted{};
  for (std::size_t k = 0; k < 6 * face_values(given, level); ++k) {
    wanted[k % 3] += std::clamp(static_cast<double>(given.face(level, 0)[k]), 0.0, 65504.0);
    sums[k % 3] += static_cast<double>(decoded.face(level, 0)[k]);
  }
  double largest = 0.0;
  for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(sums[c] / wanted[c] - 1.0));
  return largest;
}

}  // namespace welkin::test
