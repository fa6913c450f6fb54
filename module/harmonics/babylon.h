// The way back from Babylon.js's polynomial.
#pragma once

#include "welkin/engines.h"

namespace welkin::harmonics {

/// The radiance coefficients (three bands) of which `babylon_polynomial` makes this polynomial, with its constants:
/// what a file stores comes back to 1e-15.
[[nodiscard]] SphericalHarmonics radiance_of(const BabylonPolynomial& polynomial);

}  // namespace welkin::harmonics
