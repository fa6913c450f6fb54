// Cubemaps with mips: synthetic chains with every texel of every mip different from the others, and comparisons.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include "welkin/image.h"

namespace welkin::test {

inline std::size_t face_values(const Cubemap& chain, int level) {
  const auto edge = static_cast<std::size_t>(chain.level_size(level));
  return 3 * edge * edge;
}

/// Returns all values of a mip: its six faces lie one after the other.
inline std::span<const float> level_values(const Cubemap& chain, int level) {
  return {chain.face(level, 0), 6 * face_values(chain, level)};
}

/// Returns the largest error of a channel's mean over a mip.
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

/// Returns noise from 2^-`octaves` to 2^`octaves`, with as many values in each octave.
inline Cubemap noisy_chain(int size, int levels, int octaves = 6, unsigned seed = 1) {
  Cubemap chain(size, levels);
  std::mt19937 random(seed);
  for (float& value : chain.pixels()) {
    const int exponent = static_cast<int>(random() % static_cast<unsigned>(2 * octaves)) - octaves;
    value = std::ldexp(1.0F + static_cast<float>(random() % 65536U) / 65536.0F, exponent);
  }
  return chain;
}

/// Returns the chain with `change` applied to each value.
template <class Change>
Cubemap changed(const Cubemap& chain, const Change& change) {
  Cubemap result = chain;
  for (float& value : result.pixels()) value = change(value);
  return result;
}

/// Calls `compare(a, b)` with the values of both chains, in order. Returns false if their shapes differ or any call
/// returned false.
template <class Compare>
bool all_values(const Cubemap& a, const Cubemap& b, const Compare& compare) {
  return a.size() == b.size() && a.levels() == b.levels() && std::ranges::equal(a.pixels(), b.pixels(), compare);
}

}  // namespace welkin::test
