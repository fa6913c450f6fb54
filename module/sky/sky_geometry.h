// Distances and altitudes along rays through the shells of a planet's air, without cancellation.
//
// All is said in altitudes above the ground: a radius of 1e9 m would swallow the metres that matter. R is the ground's
// radius, T the air's thickness, h an altitude, r = R + h; mu is the cosine between a ray and the zenith where it
// starts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "math/direction.h"

namespace welkin::sky {

/// Returns the distance from the ground's tangent point to a sphere of altitude h: sqrt(r^2 - R^2), metres.
[[nodiscard]] inline double tangent_distance(double bottom_radius, double altitude) noexcept {
  return std::sqrt(altitude * (2.0 * bottom_radius + altitude));
}

/// Returns the altitude whose tangent distance is rho.
/// h (2 R + h) = rho^2 gives h = sqrt(R^2 + rho^2) - R, whose difference is rho^2 over the sum.
[[nodiscard]] inline double altitude_of_tangent(double bottom_radius, double rho) noexcept {
  return rho * rho / (bottom_radius + std::sqrt(bottom_radius * bottom_radius + rho * rho));
}

/// Returns the radius at `distance` along a ray.
[[nodiscard]] inline double radius_along(double radius, double mu, double distance) noexcept {
  return std::sqrt(std::max(0.0, radius * radius + distance * (2.0 * radius * mu + distance)));
}

/// Returns the altitude at `distance` along a ray; rounding may put it below the ground where the ray touches it.
/// r'^2 - r^2 = s (2 r mu + s), by the law of cosines, and h' - h = r' - r is that over r' + r: a metre on a radius of
/// 1e9 m keeps its digits.
[[nodiscard]] inline double altitude_along(double bottom_radius, double altitude, double mu, double distance) noexcept {
  const double radius = bottom_radius + altitude;
  return altitude + distance * (2.0 * radius * mu + distance) / (radius_along(radius, mu, distance) + radius);
}

/// Returns (r mu)^2 - rho^2: not negative where the line of a ray meets the ground.
[[nodiscard]] inline double ground_discriminant(double bottom_radius, double altitude, double mu) noexcept {
  const double along = (bottom_radius + altitude) * mu;
  return along * along - altitude * (2.0 * bottom_radius + altitude);
}

/// Returns whether a ray ends on the ground. One that only touches it continues to the top.
[[nodiscard]] inline bool meets_ground(double bottom_radius, double altitude, double mu) noexcept {
  return mu < 0.0 && ground_discriminant(bottom_radius, altitude, mu) > 0.0;
}

/// Returns the distance to the ground of a ray that meets it.
/// s^2 + 2 r mu s + rho^2 = 0: both roots are positive and their product is rho^2, so that the nearer one, whose own
/// formula cancels, is rho^2 over the farther.
[[nodiscard]] inline double distance_to_ground(double bottom_radius, double altitude, double mu) noexcept {
  const double root = std::sqrt(std::max(0.0, ground_discriminant(bottom_radius, altitude, mu)));
  const double along = -(bottom_radius + altitude) * mu;
  return along + root > 0.0 ? altitude * (2.0 * bottom_radius + altitude) / (along + root) : 0.0;
}

/// Returns the distance to the top of an air of thickness T, from inside of it, as if the ground were transparent.
/// s^2 + 2 r mu s = (R + T)^2 - r^2 = (T - h) (2 R + T + h) has one positive root, -r mu + sqrt((r mu)^2 + shell): for
/// r mu > 0 it cancels, and is shell over the negative of the other root.
[[nodiscard]] inline double distance_to_top(double bottom_radius, double thickness, double altitude,
                                            double mu) noexcept {
  const double along = (bottom_radius + altitude) * mu;
  const double shell = std::max(0.0, (thickness - altitude) * (2.0 * bottom_radius + thickness + altitude));
  const double root = std::sqrt(along * along + shell);
  return along > 0.0 ? shell / (along + root) : root - along;
}

/// Returns the cosine of the horizon's zenith angle.
[[nodiscard]] inline double horizon_cosine(double bottom_radius, double altitude) noexcept {
  return -tangent_distance(bottom_radius, altitude) / (bottom_radius + altitude);
}

/// Returns the direction towards a sun, of length 1. Throws `Error` (invalid_argument) if it is zero or not finite.
[[nodiscard]] inline glm::dvec3 sun_unit(const glm::dvec3& sun) {
  return math::unit_direction(sun, "the sun's direction");
}

// Between nodes: on the straight line through two neighbours, or on the cubic through four.

/// The node below a position, and the fraction of the way to the next.
struct Between {
  std::size_t node;
  double part;
};

/// Returns the node and fraction of a position among `count` nodes, 0 to count - 1, clamped to the ends.
[[nodiscard]] inline Between between(double position, int count) noexcept {
  const double inside = std::clamp(position, 0.0, static_cast<double>(count - 1));
  const std::size_t node = std::min(static_cast<std::size_t>(inside), static_cast<std::size_t>(count - 2));
  return {node, inside - static_cast<double>(node)};
}

struct Cubic {
  int first = 0;
  double weights[4]{};
};

/// Returns Lagrange weights at a position among `count` nodes, 0 to count - 1. With less than four nodes: the curve
/// through all of them, with weights of 0 for nodes that do not exist.
/// w_i = Prod_(k != i) (x - k) / (i - k). At the ends of the table the first or last four nodes serve, so that x runs
/// from 0 to 3 in place of 1 to 2.
[[nodiscard]] inline Cubic cubic_at(double position, int count) noexcept {
  Cubic cubic;
  const double inside = std::min(std::max(position, 0.0), static_cast<double>(count - 1));
  const int nodes = std::min(count, 4);
  cubic.first = std::clamp(static_cast<int>(inside) - 1, 0, count - nodes);
  const double x = inside - cubic.first;
  for (int i = 0; i < nodes; ++i) {
    double weight = 1.0;
    for (int k = 0; k < nodes; ++k) {
      if (k != i) weight *= (x - k) / (i - k);
    }
    cubic.weights[i] = weight;
  }
  return cubic;
}

// A brightness over suns that stand at the nodes of a table, between those nodes.

/// Resamples a brightness that falls by decades between suns, kSunSteps times as densely as its nodes:
/// (nodes - 1) kSunSteps + 1 values. Between nodes its logarithm is the cubic through the four nearest. Where one of
/// them is 0 it is the straight line between the two nearest, and where one of those is 0 the brightness itself is
/// linear. It leaves the range of the two nearest by no more than a tenth, and values below 1e-30 become 0. Where a
/// step of nodes changes the brightness by a factor e, straight lines between the results are within 1.3e-4.
[[nodiscard]] std::vector<float> resample_log_cubic(std::span<const double> nodes);

/// Limits a brightness that serves as a divisor: no node is darker than a hundredth of either neighbour. Where light
/// goes out, the remainder may come from one direction alone and says nothing about the sun before.
void limit_decay(std::span<double> nodes) noexcept;

// Directions at a height over which light is summed.

/// Directions of the quadrature at a height, in three ranges: over the ground, between the horizon and the horizontal,
/// and upwards. Each is a Gauss-Legendre rule, closer together about the horizon.
struct DirectionRule {
  static constexpr int kGroundNodes = 16;  ///< that carry all bands of a source
  static constexpr int kLowNodes = 8;
  static constexpr int kUpperNodes = 16;
  static constexpr int kZeniths = kGroundNodes + kLowNodes + kUpperNodes;

  std::array<double, kZeniths> cosines{};
  std::array<double, kZeniths> weights{};  ///< of the cosine
};

/// Returns the rule for a height. `horizon`: cosine of the zenith angle of the horizon there, -1 to 0.
[[nodiscard]] DirectionRule direction_rule(double horizon);

/// Throws `Error` (invalid_argument) for a viewer's altitude below 0 or above 1e9 m.
void check_altitude(double altitude_m);

// A sun's direction in the form that skies need.

/// Relative to the vertical, azimuth counted from +z towards +x.
struct SunAngles {
  double zenith_cosine = 1.0;
  double zenith_sine = 0.0;
  double azimuth_cosine = 1.0;  ///< in the zenith that of azimuth 0
  double azimuth_sine = 0.0;
};

/// Returns the angles of a direction of any length above 0. Throws `Error` (invalid_argument) for any other.
[[nodiscard]] SunAngles sun_angles(const glm::dvec3& sun);

}  // namespace welkin::sky
