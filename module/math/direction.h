// Directions as callers give them: any finite vector that is not zero.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "welkin/core.h"

namespace welkin::math {

/// Returns a direction that is very short or long at another length. Throws `Error` (invalid_argument), which calls it
/// `what`, for a direction that is zero or not finite.
[[nodiscard]] dvec3 rescaled_direction(const dvec3& direction, const char* what);

/// Returns the same direction at a length whose square neither overflows nor vanishes. Throws as above.
[[nodiscard]] inline dvec3 moderate_direction(const dvec3& direction, const char* what) {
  const double square = direction.x * direction.x + direction.y * direction.y + direction.z * direction.z;
  return square > 1e-200 && square < 1e200 ? direction : rescaled_direction(direction, what);
}

/// Returns the direction at length 1. Throws as `moderate_direction`.
[[nodiscard]] dvec3 unit_direction(const dvec3& direction, const char* what);

/// The same for many, which messages number.
[[nodiscard]] std::vector<dvec3> unit_directions(std::span<const dvec3> directions, const char* what);

/// Returns a direction of length 1, but for rounding, as it is, and any other as `unit_direction`: for calls that cost
/// little more than a square root.
[[nodiscard]] inline dvec3 as_unit_direction(const dvec3& direction, const char* what) {
  constexpr double kRounding = 0x1p-48;  // of a square: 16 units in the last place
  const double square = direction.x * direction.x + direction.y * direction.y + direction.z * direction.z;
  return std::abs(square - 1.0) <= kRounding ? direction : unit_direction(direction, what);
}

}  // namespace welkin::math
