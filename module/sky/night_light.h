// The light of a night without a moon: airglow, zodiacal light and stars too faint to be seen one by one.
//
// A fraction f of it shines in a layer above the air, which a slanted ray crosses on a longer path (van Rhijn 1921);
// the rest comes from beyond and has the same radiance everywhere. Both are dimmed by the air, to the extent that
// light scattered out of a ray is not replaced by light scattered into it. Relative to the zenith as seen from the
// ground, a direction has the radiance
// direction has
//   ((1 - f) + f X) exp(tau(0) - tau(h) X),  X = (1 - (b / (R + H))^2)^(-1/2),
// b = (R + h) sin(zenith angle), tau(h) the optical depth of the air above the observer at its wavelength: Garstang's
// model (1989) as Patat 2003 ("UBVRI night sky brightness during sunspot maximum at ESO-Paranal", appendix C) has it,
// with his f = 0.6 and H = 130 km.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "welkin/sky.h"

namespace welkin::sky {

/// Nodes evenly spaced in the zenith's cosine, from that of the horizon to 1; linear in between, within 2e-4.
inline constexpr int kNightNodes = 257;

/// The night's light as seen from an altitude within the air. Channels are those of the tables.
class NightLight {
 public:
  NightLight(const SkyTables& tables, double altitude_m);

  /// Returns whether the atmosphere has any.
  [[nodiscard]] bool any() const noexcept { return !nodes_.empty(); }

  /// Returns the radiance at the nodes: [kNightNodes][4], the last 0. Empty: there is none.
  [[nodiscard]] const std::vector<float>& nodes() const noexcept { return nodes_; }
  /// Returns the zenith's cosine at the first node.
  [[nodiscard]] double lowest() const noexcept { return lowest_; }

  /// Returns the radiance between nodes; below the horizon, the horizon's.
  [[nodiscard]] glm::dvec3 radiance(double zenith_cosine) const noexcept;

  /// Returns the irradiance on a level surface that faces up.
  [[nodiscard]] const glm::dvec3& irradiance() const noexcept { return irradiance_; }

 private:
  void integrate();

  double lowest_ = 0.0;
  std::vector<float> nodes_;
  glm::dvec3 irradiance_{0.0};
};

}  // namespace welkin::sky
