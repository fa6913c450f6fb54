// Gauss-Legendre quadrature on [-1, 1].
#pragma once

#include <vector>

namespace welkin::math {

/// Gauss-Legendre on [-1, 1].
struct GaussRule {
  int order;
  const double* nodes;
  const double* weights;
};

inline constexpr int kMaximumGaussOrder = 32;

/// The rule with `order` points, 1 to kMaximumGaussOrder: exact for polynomials of degree 2 order - 1, nodes
/// ascending and symmetric, to 2e-16. Computed at the first call; the pointers stay valid.
[[nodiscard]] GaussRule gauss_legendre(int order);

/// Texels of cubemap faces of at most this size are integrated by a Gauss rule. Above it the expansion in the texel's
/// size is as exact as a float.
inline constexpr int kLargestIntegratedFace = 128;

/// The Gauss rule that integrates over a texel of an N-texel face to double precision. The integrand's poles at u = +-i
/// sqrt(1 + v^2) are N half-widths away or more, so the error falls like rho^(-2 order) with rho = N + sqrt(N^2 + 1),
/// the sum of the half-axes of the largest ellipse about the texel (in half-widths) without a pole: nearly
/// (2 N)^(-2 order).
[[nodiscard]] GaussRule texel_rule(int size);

struct GaussNodes {
  std::vector<double> nodes;
  std::vector<double> weights;
};

/// Computes the rule for any order >= 1 in about order^2 operations.
[[nodiscard]] GaussNodes gauss_nodes(int order);

// The solid angle of a part of a cubemap face.

/// Int Int (1 + u^2 + v^2)^-3/2 du dv over the rectangle of half-widths (u_half, v_half) around (u, v), in steradians,
/// by a product Gauss rule: no difference of large angles, so small texels keep all digits.
[[nodiscard]] double rectangle_solid_angle(double u, double v, double u_half, double v_half,
                                           const GaussRule& rule) noexcept;

}  // namespace welkin::math
