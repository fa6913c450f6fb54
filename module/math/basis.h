// The constants of the spherical harmonics' recurrence.
#pragma once

#include "simd/basis_recurrence.h"

namespace welkin::math {

/// For all bands; built once.
[[nodiscard]] const simd::BasisRecurrence& basis_constants() noexcept;

// The real spherical harmonics' values at a direction, for those who call it a million times.

/// Writes Y(l, m)(x, y, z) for all l < bands and -l <= m <= l to values[l (l + 1) + m]: bands^2 of them.
///
/// (x, y, z) is a unit direction and 1 <= bands <= kMaximumBands; neither is checked. The arithmetic is the same on
/// every machine: + - * and constants that come from + - * / and correctly rounded square roots. As polynomials of
/// x, y, z as given the values are off by less than 5e-15 up to 8 bands, 2e-14 up to 16 (largest at the poles, where
/// m = 0 peaks). About 3 flops a value, no allocation. A direction that is not of unit length gives polynomials in
/// it, not harmonics.
void evaluate_basis(double x, double y, double z, int bands, double* values) noexcept;

}  // namespace welkin::math
