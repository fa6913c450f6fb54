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

/// Minimum height of the top that suns' paths are measured to, in radii of the ground: a little below that of Earth's.
constexpr double kThinnestForSuns = 0.008;

/// T / H of shells below which views' coordinates are bent, and how much.
constexpr double kThinShell = 0.04;
constexpr double kViewBend = 2.0;

// In a shell of ratio e = T / H below 0.04, a ray at the angle theta from the vertical is T / cos(theta) long, so that
// u of the length is e (1 / cos(theta) - 1): with b = 2 e,
// u / (u + b) = (1 - cos(theta)) / (1 + cos(theta)) = tan^2(theta / 2), which spreads nodes over all angles (x = 0.30
// at 57 degrees).
double bend_of(double thickness, double top_tangent) {
  const double ratio = thickness / top_tangent;
  return ratio < kThinShell ? kViewBend * ratio : 0.0;
}

// Terms of the coordinate of views to the top (ViewTerms), of suns' (SunTerms) and of azimuths' (AzimuthTerms), found
// by trial against the quadrature: those of few nodes with 8 azimuths, suns from 10 to -12 degrees, rays from 0.2 to 45
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

// An odd curve of slope 1 / width at mu = 0 that tends to -1 and 1: s' = width^2 / (mu^2 + width^2)^(3/2), and s = 1/2
// at mu = width / sqrt(3). Half of the nodes that the sunset has therefore lie within +-w / sqrt(3) of the centre, 0.39
// degrees for the few nodes' w of 2.5 radii and 0.50 for the many's of 3.25 (the Earth's sun). It needs a square root
// only, so that kernels compute the same bits as this does, and has tails that fall as mu^-3: no node is lost far from
// the horizon.
double sigmoid(double mu, double width) { return mu / std::sqrt(mu * mu + width * width); }

// The three parts of x are each 0 at the lowest sun, and their ends at mu = 1 (a = 0) add up to 1:
//   path (1 - a / A) / (1 + bend a)           is 0 at a = A,       1 - level_share at a = 0,
//   level (mu - lowest)                       is 0 at mu = lowest, level_share at mu = 1.
// `sunset_terms` scales both by 1 - sunset and adds sunset (s(mu) - s(lowest)) / (s(1) - s(lowest)). All three rise
// with mu, so that x can be inverted by halving (`sun_at`).
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

// x of u for rays to the top. Near the zenith the length exceeds the shortest by d - d_min ~ theta^2, theta the angle
// from the vertical, so that u ~ theta^2 and y ~ sqrt(zenith u) ~ theta: even steps in the angle, where u alone has a
// square root's edge: of 32 nodes on the Earth's ground the one next to the zenith stands at 46 degrees from it in u,
// and at 26 here. At the horizon, u = 1,
//   dx/du = (dx/dy) (dy/du) = (1 + 3 horizon) (1 - zenith / 2) = 1.444 for `kManyViews`,
// so nodes there stand 1.44 times as close as they would in u. Both factors keep x at 0 for u = 0 and 1 for u = 1.
double crowded(double share, const ViewTerms& terms) {
  if (!terms.crowd()) return share;
  const double y = std::sqrt(share * (terms.zenith + (1.0 - terms.zenith) * share));
  return y * (1.0 - terms.horizon + terms.horizon * y * y * y);
}

// y by Newton's method for p(y) = (1 - f) y + f y^4 - x. On [0, 1] p' > 0 and p'' = 12 f y^2 >= 0, and
// p(1) = 1 - x >= 0: from y = 1 each step stays at or above the root, and doubles the digits. For f = 0.2 the error of
// x is 2e-5 after three steps, 1e-10 after four and rounding after five, so `kNewtonSteps` leaves a margin and needs no
// test for convergence. u is then the root of (1 - z) u^2 + z u - y^2 = 0 in the form 2 c / (b + sqrt(b^2 + 4 a c)),
// which neither cancels nor divides by 1 - z = 0.
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

// A ray of length d to the ground. By the law of cosines R^2 = r^2 + d^2 + 2 r d mu, and rho^2 = r^2 - R^2, so that
// mu = -(rho^2 + d^2) / (2 r d), with d from h (straight down) to rho (the horizon). The coordinate is linear in d.
double TableMapping::ground_coordinate(double altitude, double zenith_cosine) const noexcept {
  const double rho = tangent_distance(bottom_, altitude);
  if (!(rho > altitude)) return 0.0;
  return unit((distance_to_ground(bottom_, altitude, zenith_cosine) - altitude) / (rho - altitude));
}

Ray TableMapping::ground_ray(double altitude, double coordinate) const noexcept {
  const double rho = tangent_distance(bottom_, altitude);
  const double distance = altitude + unit(coordinate) * (rho - altitude);
  if (!(distance > 0.0)) return {altitude, -1.0, true, 0.0};
  // rho^2 + d^2 = 2 rho d + (rho - d)^2, so that mu = -(rho + (rho - d)^2 / (2 d)) / r. The horizon's cosine is
  // -rho / r: the second term is how far below it the ray is, and keeps its sign and digits where both are nearly
  // equal. Written as the quotient above, mu would round to the other side of the horizon for the nodes next to it.
  const double short_of = rho - distance;
  const double mu = -(rho + short_of * short_of / (2.0 * distance)) / (bottom_ + altitude);
  return {altitude, cosine(mu), true, distance};
}

// A ray of length d to the top. (R + T)^2 = r^2 + d^2 + 2 r d mu and H^2 - rho^2 = (R + T)^2 - r^2, so that
// mu = (H^2 - rho^2 - d^2) / (2 r d), d from T - h (straight up) to rho + H (the horizon).
double TableMapping::transmittance_coordinate(double altitude, double zenith_cosine) const noexcept {
  const double shortest = thickness_ - altitude;
  const double longest = tangent_distance(bottom_, altitude) + top_tangent_;
  return unit((distance_to_top(bottom_, thickness_, altitude, zenith_cosine) - shortest) / (longest - shortest));
}

Ray TableMapping::transmittance_ray(double altitude, double coordinate) const noexcept {
  const double rho = tangent_distance(bottom_, altitude);
  const double shortest = thickness_ - altitude;
  const double longest = rho + top_tangent_;
  const double distance = shortest + unit(coordinate) * (longest - shortest);
  if (!(distance > 0.0)) return {altitude, 1.0, false, 0.0};
  const double radius = bottom_ + altitude;
  if (coordinate >= 1.0) return {altitude, cosine(-rho / radius), false, longest};
  // Bent nodes lie so close to the shortest ray that the other formula cancels there.
  if (thin() && coordinate < 0.5) {
    // H^2 - rho^2 = (R + T)^2 - (R + h)^2 = (T - h) (2 R + T + h), a product without a difference of squares.
    const double shell = std::max(0.0, shortest) * (2.0 * bottom_ + thickness_ + altitude);
    return {altitude, cosine((shell - distance * distance) / (2.0 * radius * distance)), false, distance};
  }
  // With e = rho + H - d the length that is missing to the horizon's, H^2 - rho^2 - d^2 + 2 rho
  // d = H^2 - (d - rho)^2 = H^2 - (H - e)^2 = e (2 H - e), so that mu = (-rho + e (2 H - e) / (2 d)) / r. As for rays
  // to the ground, the second term is the height over the horizon and is computed by itself.
  const double missing = (1.0 - unit(coordinate)) * (longest - shortest);
  const double mu = (-rho + missing * (2.0 * top_tangent_ - missing) / (2.0 * distance)) / radius;
  return {altitude, cosine(mu), false, distance};
}

double TableMapping::view_position(double altitude, double zenith_cosine, bool ground, int zeniths) const noexcept {
  const int half = zeniths / 2;
  const double last = half - 1;
  if (ground) return last - last * bent(ground_coordinate(altitude, zenith_cosine), view_bend_);
  const double share = transmittance_coordinate(altitude, zenith_cosine);
  return half + last * (thin() ? bent(share, view_bend_) : crowded(share, view_terms_));
}

Ray TableMapping::view_ray(double altitude, double position, int zeniths) const noexcept {
  const int half = zeniths / 2;
  const double last = half - 1.0;
  if (position <= last) return ground_ray(altitude, last > 0.0 ? unbent((last - position) / last, view_bend_) : 1.0);
  const double x = last > 0.0 ? (position - half) / last : 1.0;
  return transmittance_ray(altitude, thin() ? unbent(x, view_bend_) : uncrowded(x, view_terms_));
}

// a: 0 for a sun in the zenith, whose ray from the ground is T long, and 1 for one on the horizon, whose ray is H long.
// A sun below the horizon has a > 1: its ray is taken through the planet, which keeps the coordinate smooth where the
// sun sets.
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
  // x = 1 - kHighSuns v with v = sqrt(u (u + zenith (1 - u)^3)) in place of u. Towards the zenith 1 - x ~ theta^2, and
  // so v ~ sqrt(zenith u) ~ theta. With e = 1 - u, v = u + zenith e^3 / 2 + O(e^4): value, slope and curvature are
  // those of u where the bent part ends. v rises with u for all zenith up to the 0.76 in use (least slope 0.64), so
  // that x keeps rising with mu.
  const double u = std::min((1.0 - inside) / kHighSuns, 1.0);
  const double rest = 1.0 - u;
  return inside - kHighSuns * (std::sqrt(u * (u + terms.zenith * (rest * rest * rest))) - u);
}

double TableMapping::sun_at(const SunTerms& terms, double coordinate) const noexcept {
  if (coordinate <= 0.0) return terms.lowest;
  if (coordinate >= 1.0) return 1.0;
  double low = terms.lowest;
  double high = 1.0;
  // The interval is at most 2 wide: 60 halvings leave 2^-59, below half of a double's step for all |mu| > 2^-6. The sum
  // of three curves has no closed inverse, and nodes are placed only once per table.
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

// q >= -deep = -0.7, since u^2 / (1 + u^2) < 1: 1 + q y and dx/dy = (1 + q) / (1 + q y)^2 are positive for y in [0, 1],
// and the map can be inverted. The slope is 1 + q opposite to the sun (y = 0) and 1 / (1 + q) towards it (y = 1):
// q = 3.2 puts nodes 4.2 times as close opposite to the sun as in y, q = -0.7 puts them 3.3 times as close towards it.
// The peak falls as t^-4, and so leaves q = 0.03 for a sun of 10 degrees; the second term starts without a kink, as
// u^2.
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

// x (1 + q y) = (1 + q) y gives y = x / (1 + q (1 - x)), and cos phi = 2 y - 1.
double TableMapping::azimuth_cosine(double coordinate, double sun_zenith) const noexcept {
  const double bend = azimuth_bend(sun_zenith);
  return 2.0 * coordinate / (1.0 + bend * (1.0 - coordinate)) - 1.0;
}

double TableMapping::angle_cosine(double view_zenith, double sun_zenith, double coordinate) const noexcept {
  return cosine(view_zenith * sun_zenith +
                sine_of(view_zenith) * sine_of(sun_zenith) * azimuth_cosine(coordinate, sun_zenith));
}

}  // namespace welkin::sky
