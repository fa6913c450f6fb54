// The gentlest window that leaves no irradiance negative.
#pragma once

#include <vector>

#include "welkin/spherical_harmonics.h"

namespace welkin::harmonics {

/// 1 / (1 + lambda l^2 (l + 1)^2): of all coefficients those with the least |f - g|^2 + lambda |Laplacian of g|^2.
[[nodiscard]] double min_laplacian_factor(int l, double lambda) noexcept;

/// Band l of `harmonics` times factors[l].
[[nodiscard]] SphericalHarmonics with_factors(const SphericalHarmonics& harmonics, const std::vector<double>& factors);

/// The smallest lambda with which the irradiance is nowhere below -1e-9 of its mean, in any channel; 0 if it is not
/// without. Throws `Error` (invalid_argument) where no lambda is.
[[nodiscard]] double min_laplacian_lambda(const SphericalHarmonics& irradiance);

}  // namespace welkin::harmonics
