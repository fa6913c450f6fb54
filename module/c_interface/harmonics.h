// Coefficients as plain numbers.
#pragma once

#include <cstdint>

#include "welkin/spherical_harmonics.h"

namespace welkin::c_interface {

/// 3 bands^2 numbers. Throws `Error` (invalid_argument) for null or for bands out of range.
[[nodiscard]] SphericalHarmonics read_harmonics(std::int32_t bands, const double* coefficients, const char* name);

}  // namespace welkin::c_interface
