// How a path turns: new directions, drawn as light is scattered.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "sky/path_random.h"
#include "tables/trigonometry.h"
#include "welkin/atmosphere.h"

namespace welkin::sky {

/// Cosine of the angle of Rayleigh scattering: by rejection under (1 + c^2) / 2.
[[nodiscard]] inline double draw_rayleigh(PathRandom& random) noexcept {
  for (;;) {
    const double cosine = 2.0 * random.number() - 1.0;
    if (2.0 * random.number() < 1.0 + cosine * cosine) return cosine;
  }
}

/// Henyey and Greenstein's distribution inverted, in 1 - c so that a sharp lobe keeps its digits: with k = (1 - g)(1 +
/// g) / (1 - g + 2 g u), 2 g c = 1 + g^2 - k^2.
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

/// The unit direction at that angle from `axis`, all azimuths alike.
[[nodiscard]] inline glm::dvec3 turned(const glm::dvec3& axis, double cosine, PathRandom& random) noexcept {
  const glm::dvec3 other = std::abs(axis.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 u = glm::normalize(glm::cross(axis, other));
  const glm::dvec3 v = glm::cross(axis, u);
  const tables::SineCosine azimuth = tables::sine_cosine_of_turns(random.number());
  const double sine = std::sqrt(std::fmax(0.0, (1.0 - cosine) * (1.0 + cosine)));
  return glm::normalize(cosine * axis + sine * (azimuth.cosine * u + azimuth.sine * v));
}

}  // namespace welkin::sky
