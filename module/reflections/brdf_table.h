// Directional albedo of GGX and of Charlie sheen by a product rule that flattens their lobes.
//
// With v = view, h = half vector, l = light = 2 (v.h) h - v, a = alpha, t = tan(theta of v), and the half vector's
// slope m (tangent of its angle) in the azimuth phi from the view's, the albedo is
//
//   E = Int D(h) 4 V(v, l) (n.l) (v.h) F dh,    D (n.h) dh = m dm dphi / (pi a^2 (1 + m^2 / a^2)^2) for GGX,
//   V = 1 / (2 ((n.l) sqrt((n.v)^2 (1 - a^2) + a^2) + (n.v) sqrt((n.l)^2 (1 - a^2) + a^2)))    (Heitz 2014, eq. 99).
//
// The light is above the horizon inside the circle m^2 - 2 t m cos(phi) - 1 < 0, which has the origin inside: one end
// of m for each azimuth, at which the integrand falls to 0 with a kink. Each azimuth is integrated up to there.
//
// GGX: m = a tan(psi) turns D m dm into sin(psi) cos(psi) dpsi: the lobe is gone. What is left changes over powers of
// ten in tan(psi) = sinh(x) (at 1 / (a t), 1, 1 / a and t / a), so nodes are spread evenly over p in e^-x = p^8: nearly
// logarithmic, and nothing but products and square roots. The weight in x falls like e^-x or faster: the end is at 13.
// Azimuth: for small a and grazing views there is an edge at 90 degrees, where the end goes to infinity: Gauss's rule
// on both sides, in the square root of the angle from it.
//
// Sheen: D = (2 + 1/a) / (2 pi) sin(theta of h)^(1/a) (Estevez and Kulla 2017) with V = 1 / (4 (n.l + n.v - n.l n.v))
// (Neubelt and Pettineo 2013, after Ashikhmin): over z = cos(theta of h) from the horizon's up, nodes even in z^(1/4),
// thinning out to where the density is e^-14.
//
// Gauss's rules converge exponentially here; tests double every order and integrate over the light's hemisphere.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "reflections/brdf_kernels.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

/// Orders of a product rule.
struct AlbedoOrders {
  int towards;  ///< Gauss points over the azimuths on the view's side
  int away;     ///< and on the other
  int radii;    ///< Gauss points in each azimuth
};

/// A rule's nodes and weights as the kernels read them. Orders at most `tables::kMaximumGaussOrder`.
class AlbedoQuadrature {
 public:
  /// How radii are spread: evenly in p for GGX; for sheen thinned out to the end as 1 - (1 - y)^2, which also takes the
  /// root of D at z = 1.
  enum class Radii { even, thinning };
  AlbedoQuadrature(const AlbedoOrders& orders, Radii radii);

  [[nodiscard]] AlbedoRule rule() const noexcept;

 private:
  std::vector<float> azimuth_cosines_;
  std::vector<float> azimuth_weights_;
  std::vector<float> radius_positions_;
  std::vector<float> radius_weights_;
};

/// The smallest rules that keep the error below 1e-5, by perceptual roughness. Measured: 6e-6, of tables
/// that are interpolated too; for sheen, which exceeds 1 at grazing angles, of what is above 1.
class AlbedoRules {
 public:
  AlbedoRules();

  [[nodiscard]] AlbedoRule ggx(double roughness) const noexcept { return of(ggx_, roughness); }
  [[nodiscard]] AlbedoRule sheen(double roughness) const noexcept { return of(sheen_, roughness); }

 private:
  using Radii = AlbedoQuadrature::Radii;
  [[nodiscard]] static AlbedoRule of(const std::array<AlbedoQuadrature, 3>& rules, double roughness) noexcept;

  std::array<AlbedoQuadrature, 3> ggx_;
  std::array<AlbedoQuadrature, 3> sheen_;
};

// A BRDF table: albedo by quadrature at points, polynomials between them.

/// Throws `Error` (invalid_argument) for a size out of range.
void check_brdf(const BrdfTableOptions& options);

/// `brdf_table`; `made`: whether it had to be made.
[[nodiscard]] std::shared_ptr<const BrdfTable> shared_brdf(const BrdfTableOptions& options, const Control& control,
                                                           bool& made);

/// Returns how many floats a table has.
[[nodiscard]] std::size_t brdf_values(const BrdfTableOptions& options) noexcept;

/// A new table, whatever is cached; options must have been checked. As `brdf_table` otherwise.
[[nodiscard]] std::shared_ptr<const BrdfTable> integrated_brdf(const BrdfTableOptions& options, const Control& control);

}  // namespace welkin::reflections
