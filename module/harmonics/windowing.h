// A sum of harmonics with its slope and curvature.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "welkin/spherical_harmonics.h"

namespace welkin::harmonics {

/// Value and derivatives of the polynomial in (x, y, z) that a sum of harmonics is.
struct HarmonicDerivatives {
  double value;
  glm::dvec3 gradient;
  glm::dmat3 hessian;  ///< symmetric
};

/// `coefficients`: bands^2 numbers of one channel, index l (l + 1) + m; 1 <= bands <= kMaximumBands. The polynomial
/// is the one of `evaluate_basis`, so away from the unit sphere it is a polynomial, not a harmonic. About 25 flops a
/// coefficient, no allocation, the same bits on every machine.
[[nodiscard]] HarmonicDerivatives harmonic_derivatives(std::span<const double> coefficients, int bands,
                                                       const glm::dvec3& direction) noexcept;

// The gentlest window that leaves no irradiance negative.

/// 1 / (1 + lambda l^2 (l + 1)^2): of all coefficients those with the least |f - g|^2 + lambda |Laplacian of g|^2.
[[nodiscard]] double min_laplacian_factor(int l, double lambda) noexcept;

/// Band l of `harmonics` times factors[l].
[[nodiscard]] SphericalHarmonics with_factors(const SphericalHarmonics& harmonics, const std::vector<double>& factors);

/// The smallest lambda with which the irradiance is nowhere below -1e-9 of its mean, in any channel; 0 if it is not
/// without. Throws `Error` (invalid_argument) where no lambda is.
[[nodiscard]] double min_laplacian_lambda(const SphericalHarmonics& irradiance);

}  // namespace welkin::harmonics
