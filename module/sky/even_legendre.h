// Harmonics about the vertical without their azimuth, for as many bands as sources have (`even_basis` ends at 16).
#pragma once

#include <cstddef>

namespace welkin::sky {

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
