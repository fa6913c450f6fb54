// A sum of harmonics with its slope and curvature.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

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

}  // namespace welkin::harmonics
