// The light of a night without a moon: airglow, zodiacal light and stars too faint to be seen one by one.
//
// A share of it shines in a layer above the air, which a slanted ray crosses on a longer way (van Rhijn 1921); the rest
// comes from beyond and has the same radiance everywhere. Both are dimmed by the air, as far as light that is scattered
// out of a ray is not made up for by that scattered into it. Of the zenith's radiance as seen from the ground a
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

/// Even over the zenith's cosine, from that of the horizon to 1: what lies between is a straight line, within 2e-4.
inline constexpr int kNightNodes = 257;

/// As it is seen from an altitude within the air. Channels are those of the tables.
class NightLight {
 public:
  NightLight(const SkyTables& tables, double altitude_m);

  /// Whether the atmosphere has any.
  [[nodiscard]] bool any() const noexcept { return !nodes_.empty(); }

  /// Radiance of the nodes: [kNightNodes][4], the last 0. Empty: there is none.
  [[nodiscard]] const std::vector<float>& nodes() const noexcept { return nodes_; }
  /// The zenith's cosine at the first of them.
  [[nodiscard]] double lowest() const noexcept { return lowest_; }

  /// Between the nodes; the horizon's below it.
  [[nodiscard]] glm::dvec3 radiance(double zenith_cosine) const noexcept;

  /// On a level surface that faces up.
  [[nodiscard]] const glm::dvec3& irradiance() const noexcept { return irradiance_; }

 private:
  void integrate();

  double lowest_ = 0.0;
  std::vector<float> nodes_;
  glm::dvec3 irradiance_{0.0};
};

}  // namespace welkin::sky
