// A projection, written to the caller's structure.
#pragma once

#include <cstdint>

#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// Throws `Error` (invalid_argument) for null, and if the structure ends before the coefficients of that many bands do.
void require_room(const welkin_projection* projection, int bands);

/// Throws likewise; nothing is written then.
void write_projection(welkin_projection* projection, const Projection& light);

// Coefficients as plain numbers.

/// 3 bands^2 numbers. Throws `Error` (invalid_argument) for null or for bands out of range.
[[nodiscard]] SphericalHarmonics read_harmonics(std::int32_t bands, const double* coefficients, const char* name);

}  // namespace welkin::c_interface
