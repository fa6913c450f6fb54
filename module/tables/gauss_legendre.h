// Gauss-Legendre quadrature on [-1, 1].
#pragma once

#include <vector>

#include "simd/kernels.h"

namespace welkin::tables {

inline constexpr int kMaximumGaussOrder = 32;

/// The rule with `order` points, 1 to kMaximumGaussOrder: exact for polynomials of degree 2 order - 1, nodes
/// ascending and symmetric, to 2e-16. Built once for all orders; the pointers stay valid.
[[nodiscard]] simd::GaussRule gauss_legendre(int order);

struct GaussNodes {
  std::vector<double> nodes;
  std::vector<double> weights;
};

/// The same for any order >= 1, made anew: some order^2 operations.
[[nodiscard]] GaussNodes gauss_nodes(int order);

}  // namespace welkin::tables
