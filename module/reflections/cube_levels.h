// A cubemap's light on coarser and coarser points, which a function that is smooth over a few of them cannot tell from
// the texels.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "platform/memory.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// One level's points: each face's, `size` x `size` of them like the centres of texels, and `margin` more beyond every
/// edge in the plane of the face.
struct CubeLevel {
  int size = 0;
  int margin = 0;

  [[nodiscard]] int edge() const noexcept { return size + 2 * margin; }
  [[nodiscard]] std::size_t points() const noexcept {
    return std::size_t{6} * static_cast<std::size_t>(edge()) * static_cast<std::size_t>(edge());
  }
  /// A point's place along an axis of the face, which reaches from -1 to 1; `index` counts the margin.
  [[nodiscard]] double place(int index) const noexcept { return (2.0 * (index - margin) + 1.0) / size - 1.0; }
};

/// How light goes down a level, along one axis: to the four points about it, in such shares that the moments up to the
/// third stay. Light at a quarter of a step before or after the middle point has the same ones, mirrored.
inline constexpr std::array<double, 4> kSharesOfFour{-5.0 / 128.0, 35.0 / 128.0, 105.0 / 128.0, -7.0 / 128.0};

/// The four points from `first` on that take the light of point `index` of the finer level; share[k] is point first +
/// k's. Both count the margins of their levels.
struct LevelShares {
  LevelShares(const CubeLevel& finer, const CubeLevel& coarser, int index) noexcept {
    const int inner = index - finer.margin;
    const int parent = inner >= 0 ? inner / 2 : -((1 - inner) / 2);
    const bool after = inner != 2 * parent;
    first = parent + (after ? -1 : -2) + coarser.margin;
    for (std::size_t k = 0; k < 4; ++k) share[k] = kSharesOfFour[after ? 3 - k : k];
  }
  int first;
  std::array<double, 4> share;
};

/// Level 0 are the texels, without a margin; the others halve it while the size is even and above four.
[[nodiscard]] std::vector<CubeLevel> cube_levels(int face_size);

/// What `coarsen` needs of room: floats.
[[nodiscard]] std::size_t coarsening_floats(const CubeLevel& finer, const CubeLevel& coarser) noexcept;

/// Of one face: the light of a coarser level's points, RGB, from the finer one's. `room`: `coarsening_floats`.
void coarsen(const CubeLevel& finer, const float* from, const CubeLevel& coarser, float* to, float* room) noexcept;

}  // namespace welkin::reflections
