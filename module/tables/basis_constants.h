// The constants of the spherical harmonics' recurrence.
#pragma once

#include "simd/basis_recurrence.h"

namespace welkin::tables {

/// For all bands; built once.
[[nodiscard]] const simd::BasisRecurrence& basis_constants() noexcept;

}  // namespace welkin::tables
