// Random numbers of a path, and the directions of scattered light that are drawn with them.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "math/elementary.h"
#include "welkin/sky.h"

namespace welkin::sky {

/// Counter-based random numbers: the n-th of a path is a function of seed, path and n alone.
/// SplitMix64 (Steele, Lea and Flood 2014; constants of Stafford's variant 13), keyed by seed and path.
class PathRandom {
 public:
  PathRandom(std::uint64_t seed, std::uint64_t path) noexcept : state_(mix(mix(seed + kStep) ^ mix(~path))) {}

  /// Returns the next number in [0, 1), with 53 bits.
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

/// Draws the cosine of an angle of Rayleigh scattering, by rejection under (1 + c^2) / 2.
[[nodiscard]] inline double draw_rayleigh(PathRandom& random) noexcept {
  for (;;) {
    const double cosine = 2.0 * random.number() - 1.0;
    if (2.0 * random.number() < 1.0 + cosine * cosine) return cosine;
  }
}

/// Inverts Henyey and Greenstein's distribution, in 1 - c so that a sharp lobe keeps its digits: 2 g c = 1 + g^2 - k^2
/// with k = (1 - g)(1 + g) / (1 - g + 2 g u).
[[nodiscard]] inline double draw_henyey_greenstein(double g, PathRandom& random) noexcept {
  const double u = random.number();
  const double size = g < 0.0 ? -g : g;
  if (size < 1e-6) return 2.0 * u - 1.0;
  const double k = (1.0 - size) * (1.0 + size) / (1.0 - size + 2.0 * size * u);
  const double below_one = (k - (1.0 - size)) * (k + (1.0 - size)) / (2.0 * size);  // 1 - c
  const double cosine = 1.0 - below_one;
  const double clamped = cosine < -1.0 ? -1.0 : cosine > 1.0 ? 1.0 : cosine;
  return g < 0.0 ? -clamped : clamped;
}

[[nodiscard]] inline double draw_aerosol(AerosolPhase phase, double g, PathRandom& random) noexcept {
  for (;;) {
    const double cosine = draw_henyey_greenstein(g, random);
    if (phase == AerosolPhase::henyey_greenstein || 2.0 * random.number() < 1.0 + cosine * cosine) return cosine;
  }
}

/// Draws a unit direction at that angle from `axis`, with uniform azimuth.
[[nodiscard]] inline glm::dvec3 turned(const glm::dvec3& axis, double cosine, PathRandom& random) noexcept {
  const glm::dvec3 other = std::abs(axis.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 u = glm::normalize(glm::cross(axis, other));
  const glm::dvec3 v = glm::cross(axis, u);
  const math::SineCosine azimuth = math::sine_cosine_of_turns(random.number());
  const double sine = std::sqrt(std::fmax(0.0, (1.0 - cosine) * (1.0 + cosine)));
  return glm::normalize(cosine * axis + sine * (azimuth.cosine * u + azimuth.sine * v));
}

}  // namespace welkin::sky
