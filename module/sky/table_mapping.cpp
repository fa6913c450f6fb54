#include "sky/table_mapping.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sky/sky_geometry.h"

namespace welkin::sky {
namespace {

double unit(double x) { return std::min(1.0, std::max(0.0, x)); }
double cosine(double x) { return std::min(1.0, std::max(-1.0, x)); }
double sine_of(double x) { return std::sqrt(std::max(0.0, (1.0 - x) * (1.0 + x))); }

/// Of the top that suns' paths are measured to, in radii of the ground: somewhat less than that of Earth's air.
constexpr double kThinnestForSuns = 0.008;

/// T / H of shells below which views' coordinates are bent, and how much.
constexpr double kThinShell = 0.04;
constexpr double kViewBend = 2.0;

double bend_of(double thickness, double top_tangent) {
  const double ratio = thickness / top_tangent;
  return ratio < kThinShell ? kViewBend * ratio : 0.0;
}

// Of the coordinate of views to the top (ViewTerms), of suns' (SunTerms) and of azimuths' (AzimuthTerms). Found by
// trying against the quadrature: those of few nodes with 8 azimuths, suns from 10 to -12 degrees, rays from 0.2 to 45
// degrees above the horizon; those of many all together, with 64 views, 8 azimuths and 64 suns, from 60 to -12.
constexpr ViewTerms kManyViews{.zenith = 0.195, .horizon = 0.2};
constexpr AzimuthTerms kFewAzimuths{
    .most = 2.6, .middle = -0.0105, .width = 0.055, .deep = 0.7, .start = -0.08, .rise = 0.08};
constexpr AzimuthTerms kManyAzimuths{
    .most = 3.2, .middle = -0.0075, .width = 0.058, .deep = 0.7, .start = -0.08, .rise = 0.08};

/// How suns' nodes are shared out.
struct SunShares {
  double level;   ///< of those that do not go to the sunset
  double sunset;  ///< of all
  double radii;   ///< of the disc, in w
  double centre;
  double zenith;  ///< z, which gives the last 40 degrees two nodes more
};
// Carry light scattered before to 0.4 % from 90 to -9 degrees and 2 % to -18 (48 nodes against 192).
constexpr double kSunBend = 0.25;
constexpr double kLevelShare = 0.2;
constexpr SunShares kFewSuns{.level = kLevelShare, .sunset = 0.15, .radii = 2.5, .centre = 0.0, .zenith = 0.0};
constexpr SunShares kManySuns{.level = 0.23, .sunset = 0.2, .radii = 3.25, .centre = -0.0053, .zenith = 0.76};
constexpr double kMinSunset = 0.004;  ///< w of a sun that is a point, radians
constexpr int kHalvings = 60;
constexpr int kNewtonSteps = 8;

double sigmoid(double mu, double width) { return mu / std::sqrt(mu * mu + width * width); }

SunTerms smooth_terms(double lowest, double zenith, double level_share = kLevelShare) {
  return {.bend = kSunBend,
          .path = 1.0 - level_share,
          .level = level_share / (1.0 - lowest),
          .lowest = lowest,
          .sunset = 0.0,
          .width = 1.0,
          .centre = 0.0,
          .sunset_lowest = 0.0,
          .zenith = zenith};
}

SunTerms sunset_terms(double lowest, double sun_radius_degrees, const SunShares& shares) {
  SunTerms terms = smooth_terms(lowest, shares.zenith, shares.level);
  terms.path *= 1.0 - shares.sunset;
  terms.level *= 1.0 - shares.sunset;
  terms.width = std::max(kMinSunset, shares.radii * sun_radius_degrees * std::numbers::pi / 180.0);
  terms.centre = shares.centre;
  terms.sunset_lowest = sigmoid(terms.lowest - terms.centre, terms.width);
  terms.sunset = shares.sunset / (sigmoid(1.0 - terms.centre, terms.width) - terms.sunset_lowest);
  return terms;
}

double crowded(double share, const ViewTerms& terms) {
  if (!terms.crowd()) return share;
  const double y = std::sqrt(share * (terms.zenith + (1.0 - terms.zenith) * share));
  return y * (1.0 - terms.horizon + terms.horizon * y * y * y);
}

// y by Newton's method from above, where the quartic is convex: each step stays above, and doubles the digits.
double uncrowded(double x, const ViewTerms& terms) {
  if (!terms.crowd()) return x;
  const double f = terms.horizon;
  double y = 1.0;
  for (int i = 0; i < kNewtonSteps; ++i) {
    y -= (y * (1.0 - f + f * y * y * y) - x) / (1.0 - f + 4.0 * f * y * y * y);
  }
  const double square = std::max(0.0, y) * std::max(0.0, y);
  const double z = terms.zenith;
  return unit(2.0 * square / (z + std::sqrt(z * z + 4.0 * (1.0 - z) * square)));
}

}  // namespace

TableMapping::TableMapping(double bottom_radius, double top_radius, double lowest_sun_sine, double sun_radius_degrees,
                           TableNodes nodes) noexcept
    : bottom_(bottom_radius),
      thickness_(top_radius - bottom_radius),
      top_tangent_(tangent_distance(bottom_radius, top_radius - bottom_radius)),
      view_bend_(bend_of(thickness_, top_tangent_)),
      view_terms_(nodes.many_views && !thin() ? kManyViews : ViewTerms{}),
      sun_thickness_(std::max(thickness_, kThinnestForSuns * bottom_radius)),
      sun_tangent_(tangent_distance(bottom_radius, sun_thickness_)),
      lowest_(scaled_sun_distance(lowest_sun_sine)),
      smooth_sun_terms_(smooth_terms(lowest_sun_sine, nodes.high_suns ? kManySuns.zenith : 0.0)),
      sun_terms_(sunset_terms(lowest_sun_sine, sun_radius_degrees, nodes.many_suns ? kManySuns : kFewSuns)),
      azimuth_terms_(nodes.many_azimuths ? kManyAzimuths : kFewAzimuths) {
  if (!nodes.high_suns) sun_terms_.zenith = 0.0;
}

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
  // Bent nodes lie so close to the shortest ray that the other formula cancels there.
  if (thin() && coordinate < 0.5) {
    const double shell = std::max(0.0, shortest) * (2.0 * bottom_ + thickness_ + altitude);
    return {cosine((shell - distance * distance) / (2.0 * radius * distance)), false, distance};
  }
  // From the horizon up: d = rho + H - e, mu = -rho / r + e (2 (rho + H) - e - 2 rho) / (2 r d)
  const double missing = (1.0 - unit(coordinate)) * (longest - shortest);
  const double mu = (-rho + missing * (2.0 * top_tangent_ - missing) / (2.0 * distance)) / radius;
  return {cosine(mu), false, distance};
}

double TableMapping::view_position(double altitude, double zenith_cosine, bool ground, int zeniths) const noexcept {
  const int half = zeniths / 2;
  const double last = half - 1;
  if (ground) return last - last * bent(ground_coordinate(altitude, zenith_cosine), view_bend_);
  const double share = transmittance_coordinate(altitude, zenith_cosine);
  return half + last * (thin() ? bent(share, view_bend_) : crowded(share, view_terms_));
}

double TableMapping::view_position(double altitude, double zenith_cosine, int zeniths) const noexcept {
  return view_position(altitude, zenith_cosine, meets_ground(bottom_, altitude, zenith_cosine), zeniths);
}

ViewRay TableMapping::view_ray(double altitude, double position, int zeniths) const noexcept {
  const int half = zeniths / 2;
  const double last = half - 1.0;
  if (position <= last) return ground_ray(altitude, last > 0.0 ? unbent((last - position) / last, view_bend_) : 1.0);
  const double x = last > 0.0 ? (position - half) / last : 1.0;
  return transmittance_ray(altitude, thin() ? unbent(x, view_bend_) : uncrowded(x, view_terms_));
}

double TableMapping::scaled_sun_distance(double sun_zenith_cosine) const noexcept {
  const double distance = distance_to_top(bottom_, sun_thickness_, 0.0, sun_zenith_cosine);
  return std::max(0.0, distance - sun_thickness_) / (sun_tangent_ - sun_thickness_);
}

double TableMapping::coordinate_of_sun(const SunTerms& terms, double sun_zenith_cosine) const noexcept {
  if (sun_zenith_cosine >= 1.0) return 1.0;
  const double mu = std::max(sun_zenith_cosine, terms.lowest);
  const double a = scaled_sun_distance(mu);
  const double x = terms.path * std::max(1.0 - a / lowest_, 0.0) / (1.0 + terms.bend * a) +
                   terms.level * (mu - terms.lowest) +
                   terms.sunset * (sigmoid(mu - terms.centre, terms.width) - terms.sunset_lowest);
  const double inside = unit(x);
  const double u = std::min((1.0 - inside) / kHighSuns, 1.0);
  const double rest = 1.0 - u;
  return inside - kHighSuns * (std::sqrt(u * (u + terms.zenith * (rest * rest * rest))) - u);
}

double TableMapping::sun_at(const SunTerms& terms, double coordinate) const noexcept {
  if (coordinate <= 0.0) return terms.lowest;
  if (coordinate >= 1.0) return 1.0;
  double low = terms.lowest;
  double high = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = low + 0.5 * (high - low);
    (coordinate_of_sun(terms, middle) < coordinate ? low : high) = middle;
  }
  return low + 0.5 * (high - low);
}

double TableMapping::sun_coordinate(double sun_zenith_cosine) const noexcept {
  return coordinate_of_sun(sun_terms_, sun_zenith_cosine);
}
double TableMapping::sun_zenith_cosine(double coordinate) const noexcept { return sun_at(sun_terms_, coordinate); }

double TableMapping::smooth_sun_coordinate(double sun_zenith_cosine) const noexcept {
  return coordinate_of_sun(smooth_sun_terms_, sun_zenith_cosine);
}
double TableMapping::smooth_sun_zenith_cosine(double coordinate) const noexcept {
  return sun_at(smooth_sun_terms_, coordinate);
}

double TableMapping::azimuth_bend(double sun_zenith) const noexcept {
  const AzimuthTerms& terms = azimuth_terms_;
  const double t = (sun_zenith - terms.middle) / terms.width;
  const double u = std::max(terms.start - sun_zenith, 0.0) / terms.rise;
  const double fall = 1.0 + t * t;
  return terms.most / (fall * fall) - terms.deep * u * u / (1.0 + u * u);
}

double TableMapping::bent_azimuth(double azimuth_cosine, double bend) noexcept {
  const double even = unit(0.5 + 0.5 * azimuth_cosine);
  return unit((1.0 + bend) * even / (1.0 + bend * even));
}

double TableMapping::azimuth_cosine(double coordinate, double sun_zenith) const noexcept {
  const double bend = azimuth_bend(sun_zenith);
  return 2.0 * coordinate / (1.0 + bend * (1.0 - coordinate)) - 1.0;
}

double TableMapping::angle_cosine(double view_zenith, double sun_zenith, double coordinate) const noexcept {
  return cosine(view_zenith * sun_zenith +
                sine_of(view_zenith) * sine_of(sun_zenith) * azimuth_cosine(coordinate, sun_zenith));
}

}  // namespace welkin::sky
