#include "sky/table_mapping.h"

#include <algorithm>
#include <cmath>

#include "sky/sky_geometry.h"

namespace welkin::sky {
namespace {

double unit(double x) { return std::min(1.0, std::max(0.0, x)); }
double cosine(double x) { return std::min(1.0, std::max(-1.0, x)); }
double sine_of(double x) { return std::sqrt(std::max(0.0, (1.0 - x) * (1.0 + x))); }

/// Products of sines below: straight up or down, for view or sun.
constexpr double kNoAzimuth = 1e-12;

/// Of the top that suns' paths are measured to, in radii of the ground: somewhat less than that of Earth's air.
constexpr double kThinnestForSuns = 0.008;

}  // namespace

TableMapping::TableMapping(double bottom_radius, double top_radius, double lowest_sun_sine) noexcept
    : bottom_(bottom_radius),
      thickness_(top_radius - bottom_radius),
      top_tangent_(tangent_distance(bottom_radius, top_radius - bottom_radius)),
      sun_thickness_(std::max(thickness_, kThinnestForSuns * bottom_radius)),
      sun_tangent_(tangent_distance(bottom_radius, sun_thickness_)),
      lowest_(scaled_sun_distance(lowest_sun_sine)) {}

double TableMapping::height_coordinate(double altitude) const noexcept {
  const double inside = std::min(thickness_, std::max(0.0, altitude));
  return unit(tangent_distance(bottom_, inside) / top_tangent_);
}

double TableMapping::altitude(double coordinate) const noexcept {
  if (coordinate >= 1.0) return thickness_;
  return std::min(thickness_, altitude_of_tangent(bottom_, std::max(0.0, coordinate) * top_tangent_));
}

// A ray of length d to the ground: mu = -(rho^2 + d^2) / (2 r d), d from h (straight down) to rho (the horizon).
double TableMapping::ground_coordinate(double altitude, double zenith_cosine) const noexcept {
  const double rho = tangent_distance(bottom_, altitude);
  if (!(rho > altitude)) return 0.0;
  return unit((distance_to_ground(bottom_, altitude, zenith_cosine) - altitude) / (rho - altitude));
}

ViewRay TableMapping::ground_ray(double altitude, double coordinate) const noexcept {
  const double rho = tangent_distance(bottom_, altitude);
  const double distance = altitude + unit(coordinate) * (rho - altitude);
  if (!(distance > 0.0)) return {-1.0, true, 0.0};
  // (rho - d)^2 / (2 r d) above the horizon's rho / r: keeps its sign and digits next to the horizon
  const double short_of = rho - distance;
  const double mu = -(rho + short_of * short_of / (2.0 * distance)) / (bottom_ + altitude);
  return {cosine(mu), true, distance};
}

// A ray of length d to the top: mu = (H^2 - rho^2 - d^2) / (2 r d), d from T - h (straight up) to rho + H (the
// horizon).
double TableMapping::transmittance_coordinate(double altitude, double zenith_cosine) const noexcept {
  const double shortest = thickness_ - altitude;
  const double longest = tangent_distance(bottom_, altitude) + top_tangent_;
  return unit((distance_to_top(bottom_, thickness_, altitude, zenith_cosine) - shortest) / (longest - shortest));
}

ViewRay TableMapping::transmittance_ray(double altitude, double coordinate) const noexcept {
  const double rho = tangent_distance(bottom_, altitude);
  const double shortest = thickness_ - altitude;
  const double longest = rho + top_tangent_;
  const double distance = shortest + unit(coordinate) * (longest - shortest);
  if (!(distance > 0.0)) return {1.0, false, 0.0};
  const double radius = bottom_ + altitude;
  if (coordinate >= 1.0) return {cosine(-rho / radius), false, longest};
  // From the horizon up: d = rho + H - e, mu = -rho / r + e (2 (rho + H) - e - 2 rho) / (2 r d)
  const double missing = (1.0 - unit(coordinate)) * (longest - shortest);
  const double mu = (-rho + missing * (2.0 * top_tangent_ - missing) / (2.0 * distance)) / radius;
  return {cosine(mu), false, distance};
}

double TableMapping::view_position(double altitude, double zenith_cosine, bool ground, int zeniths) const noexcept {
  const int half = zeniths / 2;
  const double last = half - 1;
  if (ground) return last - last * ground_coordinate(altitude, zenith_cosine);
  return half + last * transmittance_coordinate(altitude, zenith_cosine);
}

double TableMapping::view_position(double altitude, double zenith_cosine, int zeniths) const noexcept {
  return view_position(altitude, zenith_cosine, meets_ground(bottom_, altitude, zenith_cosine), zeniths);
}

ViewRay TableMapping::view_ray(double altitude, double position, int zeniths) const noexcept {
  const int half = zeniths / 2;
  const double last = half - 1.0;
  if (position <= last) return ground_ray(altitude, last > 0.0 ? (last - position) / last : 1.0);
  return transmittance_ray(altitude, last > 0.0 ? (position - half) / last : 1.0);
}

double TableMapping::scaled_sun_distance(double sun_zenith_cosine) const noexcept {
  const double distance = distance_to_top(bottom_, sun_thickness_, 0.0, sun_zenith_cosine);
  return std::max(0.0, distance - sun_thickness_) / (sun_tangent_ - sun_thickness_);
}

double TableMapping::sun_coordinate(double sun_zenith_cosine) const noexcept {
  const double a = scaled_sun_distance(sun_zenith_cosine);
  return std::max(1.0 - a / lowest_, 0.0) / (1.0 + a);
}

double TableMapping::sun_zenith_cosine(double coordinate) const noexcept {
  const double x = unit(coordinate);
  const double a = lowest_ * (1.0 - x) / (1.0 + x * lowest_);
  const double longer = a * (sun_tangent_ - sun_thickness_);
  const double distance = sun_thickness_ + longer;
  // H^2 - d^2 = 2 R T - l (2 T + l)
  const double reached = longer * (2.0 * sun_thickness_ + longer);
  return cosine((2.0 * bottom_ * sun_thickness_ - reached) / (2.0 * bottom_ * distance));
}

double TableMapping::angle_coordinate(double view_zenith, double sun_zenith, double nu) noexcept {
  const double sines = sine_of(view_zenith) * sine_of(sun_zenith);
  return sines > kNoAzimuth ? unit(0.5 + 0.5 * (nu - view_zenith * sun_zenith) / sines) : 0.5;
}

double TableMapping::angle_cosine(double view_zenith, double sun_zenith, double coordinate) noexcept {
  return cosine(view_zenith * sun_zenith + sine_of(view_zenith) * sine_of(sun_zenith) * (2.0 * coordinate - 1.0));
}

}  // namespace welkin::sky
