// Directions as callers give them: any finite vector that is not zero.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "welkin/core.h"

namespace welkin::math {

/// Returns a very short or very long direction rescaled. Throws `Error` (invalid_argument), in whose message it is
/// `what`, for a direction that is zero or not finite.
[[nodiscard]] dvec3 rescaled_direction(const dvec3& direction, const char* what);

/// Returns the same direction at a length whose square neither overflows nor vanishes. Throws the same errors.
[[nodiscard]] inline dvec3 moderate_direction(const dvec3& direction, const char* what) {
  const double square = direction.x * direction.x + direction.y * direction.y + direction.z * direction.z;
  return square > 1e-200 && square < 1e200 ? direction : rescaled_direction(direction, what);
}

/// Returns the direction at length 1. Throws the same errors.
[[nodiscard]] dvec3 unit_direction(const dvec3& direction, const char* what);

/// Returns many directions at length 1. Messages name the index of a refused one.
[[nodiscard]] std::vector<dvec3> unit_directions(std::span<const dvec3> directions, const char* what);

/// Returns a direction that has length 1, except for rounding, unchanged, and any other one as `unit_direction` does.
/// For calls that cost little more than a square root.
[[nodiscard]] inline dvec3 as_unit_direction(const dvec3& direction, const char* what) {
  constexpr double kRounding = 0x1p-48;  // of a square: 16 units in the last place
  const double square = direction.x * direction.x + direction.y * direction.y + direction.z * direction.z;
  return std::abs(square - 1.0) <= kRounding ? direction : unit_direction(direction, what);
}

}  // namespace welkin::math
