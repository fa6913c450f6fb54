// Cubemaps with mips: made up, with every texel of every level unlike the others, looked at and compared.
#pragma once

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

/// All values of a level: its six faces lie one after the other.
inline std::span<const float> level_values(const Cubemap& chain, int level) {
  return {chain.face(level, 0), 6 * face_values(chain, level)};
}

/// Noise from 2^-`octaves` to 2^`octaves`, as many in each octave.
inline Cubemap noisy_chain(int size, int levels, int octaves = 6, unsigned seed = 1) {
  Cubemap chain(size, levels);
  std::mt19937 random(seed);
  for (int level = 0; level < levels; ++level) {
    for (int face = 0; face < 6; ++face) {
      float* to = chain.face(level, face);
      for (std::size_t i = 0; i < face_values(chain, level); ++i) {
        const int exponent = static_cast<int>(random() % static_cast<unsigned>(2 * octaves)) - octaves;
        to[i] = std::ldexp(1.0F + static_cast<float>(random() % 65536U) / 65536.0F, exponent);
      }
    }
  }
  return chain;
}

/// The chain after each value went through `change`.
template <class Change>
Cubemap changed(const Cubemap& chain, const Change& change) {
  Cubemap result(chain.size(), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    for (int face = 0; face < 6; ++face) {
      for (std::size_t i = 0; i < face_values(chain, level); ++i) {
        result.face(level, face)[i] = change(chain.face(level, face)[i]);
      }
    }
  }
  return result;
}

/// Calls `compare(a, b)` with the values of both chains, in order; false if they have not the same shape or it was ever
/// false.
template <class Compare>
bool all_values(const Cubemap& a, const Cubemap& b, const Compare& compare) {
  if (a.size() != b.size() || a.levels() != b.levels()) return false;
  for (int level = 0; level < a.levels(); ++level) {
    for (int face = 0; face < 6; ++face) {
      for (std::size_t i = 0; i < face_values(a, level); ++i) {
        if (!compare(a.face(level, face)[i], b.face(level, face)[i])) return false;
      }
    }
  }
  return true;
}

}  // namespace welkin::test
