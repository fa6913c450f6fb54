// Random numbers by counter: the n-th of a path is a function of seed, path and n, whoever asks and when.
#pragma once

#include <cstdint>

namespace welkin::sky {

/// SplitMix64 (Steele, Lea and Flood 2014; constants of Stafford's variant 13), keyed by seed and path.
class PathRandom {
 public:
  PathRandom(std::uint64_t seed, std::uint64_t path) noexcept : state_(mix(mix(seed + kStep) ^ mix(~path))) {}

  /// In [0, 1), 53 bits.
  double number() noexcept {
    state_ += kStep;
    return static_cast<double>(mix(state_) >> 11U) * 0x1p-53;
  }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15U;

  static std::uint64_t mix(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_;
};

}  // namespace welkin::sky
