// Distances and altitudes along rays through the shells of a planet's air, without cancellation.
//
// All is said in altitudes above the ground: a radius of 1e9 m would swallow the metres that matter. R is the ground's
// radius, T the air's thickness, h an altitude, r = R + h; mu is the cosine between a ray and the zenith where it
// starts.
#pragma once

#include <algorithm>
#include <cmath>

namespace welkin::sky {

/// How far from the ground's tangent point a sphere of altitude h is: sqrt(r^2 - R^2), metres.
[[nodiscard]] inline double tangent_distance(double bottom_radius, double altitude) noexcept {
  return std::sqrt(altitude * (2.0 * bottom_radius + altitude));
}

/// Its inverse: the altitude whose tangent distance is rho.
[[nodiscard]] inline double altitude_of_tangent(double bottom_radius, double rho) noexcept {
  return rho * rho / (bottom_radius + std::sqrt(bottom_radius * bottom_radius + rho * rho));
}

/// Radius at `distance` along a ray.
[[nodiscard]] inline double radius_along(double radius, double mu, double distance) noexcept {
  return std::sqrt(std::max(0.0, radius * radius + distance * (2.0 * radius * mu + distance)));
}

/// Altitude at `distance` along a ray; may be a rounding below the ground where the ray touches it.
[[nodiscard]] inline double altitude_along(double bottom_radius, double altitude, double mu, double distance) noexcept {
  const double radius = bottom_radius + altitude;
  return altitude + distance * (2.0 * radius * mu + distance) / (radius_along(radius, mu, distance) + radius);
}

/// (r mu)^2 - rho^2: not negative where the line of a ray meets the ground.
[[nodiscard]] inline double ground_discriminant(double bottom_radius, double altitude, double mu) noexcept {
  const double along = (bottom_radius + altitude) * mu;
  return along * along - altitude * (2.0 * bottom_radius + altitude);
}

/// Whether a ray ends on the ground. One that only touches it goes on to the top.
[[nodiscard]] inline bool meets_ground(double bottom_radius, double altitude, double mu) noexcept {
  return mu < 0.0 && ground_discriminant(bottom_radius, altitude, mu) > 0.0;
}

/// Distance to the ground of a ray that meets it.
[[nodiscard]] inline double distance_to_ground(double bottom_radius, double altitude, double mu) noexcept {
  const double root = std::sqrt(std::max(0.0, ground_discriminant(bottom_radius, altitude, mu)));
  const double along = -(bottom_radius + altitude) * mu;
  return along + root > 0.0 ? altitude * (2.0 * bottom_radius + altitude) / (along + root) : 0.0;
}

/// Distance to the top of an air of thickness T, from inside of it, the ground taken for transparent.
[[nodiscard]] inline double distance_to_top(double bottom_radius, double thickness, double altitude,
                                            double mu) noexcept {
  const double along = (bottom_radius + altitude) * mu;
  const double shell = std::max(0.0, (thickness - altitude) * (2.0 * bottom_radius + thickness + altitude));
  const double root = std::sqrt(along * along + shell);
  return along > 0.0 ? shell / (along + root) : root - along;
}

/// Cosine of the horizon's zenith angle.
[[nodiscard]] inline double horizon_cosine(double bottom_radius, double altitude) noexcept {
  return -tangent_distance(bottom_radius, altitude) / (bottom_radius + altitude);
}

}  // namespace welkin::sky
