// Harmonics about the vertical, and what turns them into Welkin's.
//
// About the vertical means: polar axis y, azimuth from +z towards +x, the same basis functions. A sky whose sun is at
// azimuth 0 is even in azimuth: its coefficients (l, m >= 0) are all there is, at even_index(l, m).
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>

#include "sky/sky_geometry.h"

namespace welkin::sky {

[[nodiscard]] constexpr std::size_t even_index(int l, int m) noexcept {
  return static_cast<std::size_t>(l * (l + 1) / 2 + m);
}
[[nodiscard]] constexpr std::size_t even_count(int bands) noexcept { return even_index(bands, 0); }

/// Y(l, m) for all l < bands, 0 <= m <= l, at azimuth 0.
void even_basis(double zenith_cosine, double zenith_sine, int bands, std::span<double> values);

/// Computes what `rotate_even` needs, once in the process: some milliseconds, and the only time that it allocates.
void prepare_turns();

/// Coefficients about the vertical with the sun at azimuth 0, to Welkin's (bands^2 of them) with the sun at its own:
///   c(l, m) cos(m azimuth) and c(l, m) sin(m azimuth), then y z x become x y z.
/// Allocates nothing.
void rotate_even(std::span<const glm::dvec3> even, int bands, const SunAngles& sun,
                 std::span<glm::dvec3> coefficients) noexcept;

// Harmonics about the vertical without their azimuth, for as many bands as sources have (`even_basis` ends at 16).

/// Pairs l >= m >= 0, ordered by m: those of m start at m (2 bands - m + 1) / 2.
[[nodiscard]] constexpr std::size_t pair_count(int bands) noexcept {
  return static_cast<std::size_t>(bands * (bands + 1) / 2);
}
[[nodiscard]] constexpr std::size_t pair_index(int bands, int l, int m) noexcept {
  return static_cast<std::size_t>(m * (2 * bands - m + 1) / 2 + l - m);
}

/// Orthonormal: Y(l, m) = value cos(m phi), sqrt(2) in it for m > 0. `values`: [pair_count(bands)].
void even_legendre(int bands, double zenith_cosine, double* values) noexcept;

}  // namespace welkin::sky
