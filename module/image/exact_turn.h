// Turns that take texels to texels: nothing is interpolated, every texel stays what it is.
#pragma once

#include <glm/mat3x3.hpp>
#include <optional>

#include "welkin/control.h"
#include "welkin/image.h"

namespace welkin::image {

/// Whether each entry is within 1e-9 of 0, 1 or -1: one of a cube's 48 symmetries.
[[nodiscard]] bool is_cube_symmetry(const glm::dmat3& turn) noexcept;

/// The result, if the turn is one of a cube's 48 symmetries: each entry within 1e-9 of 0, 1 or -1.
[[nodiscard]] std::optional<CubemapImage> turned_exactly(const CubemapView& source, const glm::dmat3& turn,
                                                         const Control& control);

/// The result, if the turn leaves the axis y in its place or turns it over, and moves the columns by whole texels, to
/// 1e-6 texels. (The mirror that exchanges front and back does so if the width is even.)
[[nodiscard]] std::optional<LatLongImage> turned_exactly(const LatLongView& source, const glm::dmat3& turn,
                                                         const Control& control);

}  // namespace welkin::image
