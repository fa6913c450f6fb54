// Phase functions: the share of scattered light that goes where, per steradian; their integral over the sphere is 1.
//
// `cosine` is of the angle by which light turns: 1 straight on. Only + - * / and square roots: the same bits
// everywhere.
#pragma once

#include <cmath>
#include <numbers>

#include "welkin/atmosphere.h"

namespace welkin::sky {

/// Of molecules, without their small anisotropy.
[[nodiscard]] inline double rayleigh_phase(double cosine) noexcept {
  return 3.0 / (16.0 * std::numbers::pi) * (1.0 + cosine * cosine);
}

/// (1 + g^2 - 2 g cosine)^(3/2) without the cancellation at g cosine = 1: the square of a difference and a product,
/// neither negative.
[[nodiscard]] inline double henyey_greenstein_denominator(double g, double cosine) noexcept {
  const double ahead = g < 0.0 ? 1.0 + cosine : 1.0 - cosine;
  const double size = g < 0.0 ? -g : g;
  const double square = (1.0 - size) * (1.0 - size) + 2.0 * size * (ahead > 0.0 ? ahead : 0.0);
  return square * std::sqrt(square);
}

/// Henyey and Greenstein 1941. The mean cosine is g.
[[nodiscard]] inline double henyey_greenstein_phase(double g, double cosine) noexcept {
  return (1.0 - g * g) / (4.0 * std::numbers::pi * henyey_greenstein_denominator(g, cosine));
}

/// Cornette and Shanks 1992, equation 8. Rayleigh's for g = 0; the mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)).
[[nodiscard]] inline double cornette_shanks_phase(double g, double cosine) noexcept {
  return 3.0 / (8.0 * std::numbers::pi) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + cosine * cosine) /
         henyey_greenstein_denominator(g, cosine);
}

[[nodiscard]] inline double aerosol_phase(AerosolPhase phase, double g, double cosine) noexcept {
  return phase == AerosolPhase::cornette_shanks ? cornette_shanks_phase(g, cosine) : henyey_greenstein_phase(g, cosine);
}

}  // namespace welkin::sky
