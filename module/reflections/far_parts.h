// The far parts of narrow lobes: some of them are found, the others mixed from those.
#pragma once

#include <array>
#include <vector>

#include "image/sphere_grid.h"
#include "reflections/bright_lights.h"
#include "reflections/narrow.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Over alpha^2 the Gaussians that are far depend on q = alpha^2 / (1 - alpha^2) as e^(-t q), so that few are enough:
/// the others lie on a polynomial in y = e^(-T q), T the largest t, through them, which is exact for t = 0 and t = T.
/// Error over the lobe's peak: 7e-5 for T q up to 0.5 and two of them, 1e-4 for 0.8 and three, 2e-4 for 1.2 and four,
/// 7e-4 for 2.0 and five; more of them beyond. Even light is met exactly: see `FarParts`.
[[nodiscard]] double far_place(double largest, double alpha) noexcept;

/// Alphas whose far parts are found themselves: those that are given, or some from the least to the largest, denser
/// at the ends.
[[nodiscard]] std::vector<double> far_alphas(const NarrowSplit& split, const std::vector<double>& alphas);

/// The far parts of all narrow mips.
struct FarParts {
  double largest = 0.0;          ///< T
  std::vector<double> alphas;    ///< see `far_alphas`
  std::vector<double> energies;  ///< of even light that each of their parts takes
  std::vector<image::SphereGrid> grids;
  BrightLights bright;           ///< taken out of the grids
  int bright_texels = 0;         ///< how many texels those are
  double contrast = 0.0;         ///< see `contrast_of`
  std::vector<double> spectrum;  ///< energies by degrees, see `energies_of`

  /// `energy`: what the part of `alpha` takes of even light. The near part has the rest, so it is met exactly.
  void sample(double alpha, double energy, int size, const std::array<float*, 6>& faces, const Control& control) const;

  [[nodiscard]] std::vector<double> shares(double alpha, double energy) const;
};

}  // namespace welkin::reflections
