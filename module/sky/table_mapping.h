// Which atmospheric state a texel of a sky table stands for, and back (after Bruneton 2017, in altitudes).
//
// Coordinates x are from 0 to 1: node k of n stands at x = k / (n - 1), so tables hold their own ends. Positions are
// nodes counted from 0 to n - 1. With rho = sqrt(r^2 - R^2) and H that of the top:
//   heights (all tables)            x = rho / H
//   view zeniths (scattering)       half the nodes for rays that end on the ground, the horizon in the middle; in thin
//       shells (T / H below 0.04; the Earth's 0.07), where all rays but the lowest are about as short, bent: y of x
//       becomes (1 + b) y / (y + b), b = 2 T / H. In thicker ones x = y (1 - f + f y^3), y^2 = u (z + (1 - z) u), for
//       rays to the top, u the share of the length: even in the angle about the zenith, and dense at the horizon
//   zeniths (transmittance)         x = (d - d_min) / (d_max - d_min), d the distance to the top
//   sun zeniths (scattering, irradiance)   x = path max(1 - a / A, 0) / (1 + bend a) + level (mu_s - lowest) + sunset
//       (s(mu_s) - s(lowest)), s(mu) = (mu - c) / sqrt((mu - c)^2 + w^2), a the length of the sun's ray from the ground
//       beyond T over H - T, A the lowest sun's, w about three radii of the disc: while it sets, light in the shadow's
//       direction goes out within half a degree, and a fifth of the nodes is there; `bend` spreads them over the
//       twilight as evenly as light falls, `level` over the day. The top counts as no lower than 0.008 R: under a
//       thinner shell a day's paths are all so much shorter than the horizon's that they would share an interval. Of
//       many suns those above about 10 degrees, u = (1 - x) / 0.19 below 1, are bent so that sqrt(u (u + z (1 - u)^3))
//       takes u's place: even in the angle about the zenith, since what differs between azimuths goes as its sine,
//       which is a root of u. Next to u = 1 that is u to the second derivative
//   sun angles                      x = (1 + q) y / (1 + q y), y = (1 + cos phi) / 2, phi the azimuth between view and
//       sun. q = most / (1 + ((mu_s - middle) / width)^2)^2 - deep u^2 / (1 + u^2), u = max(start - mu_s, 0) / rise:
//       about sunset nodes crowd opposite to the sun, where low rays run along the edge of the planet's shadow and meet
//       it at a distance that changes fast with the azimuth; far below the horizon towards the sun, where all light is
// Where nodes are dense others are missing, which only tables of many nodes can spare: z, f, w, c, the suns' shares and
// q are those of `TableNodes`.
// (Bruneton has the cosine nu between view and sun for the last. Most of its nodes are then angles that no azimuth
// gives: they need filling, and interpolation across them has kinks; cos phi has none, and is as even about the sun's
// plane.)
#pragma once

namespace welkin::sky {

/// A coordinate from 0 to 1 whose nodes crowd at 0, y of x = (1 + b) y / (y + b), and back; b 0: the same.
[[nodiscard]] inline double bent(double y, double bend) noexcept {
  return bend > 0.0 ? (1.0 + bend) * y / (y + bend) : y;
}
[[nodiscard]] inline double unbent(double x, double bend) noexcept {
  return bend > 0.0 ? bend * x / (1.0 + bend - x) : x;
}

/// A ray: from an altitude along a zenith cosine, to the ground or the top.
struct Ray {
  double altitude;
  double zenith_cosine;
  bool ground;    ///< ends there
  double length;  ///< metres

  bool operator==(const Ray&) const = default;
};

/// The axes of a scattering table that have so many nodes that they crowd where light is sharp. Only `table_nodes`
/// (sky/table_sizes.h) may derive them from options.
struct TableNodes {
  bool many_views = false;
  bool many_suns = false;
  bool high_suns = false;  ///< those of high suns are bent
  bool many_azimuths = false;
};

/// Coefficients of the coordinate of views to the top, of its share u of the length.
struct ViewTerms {
  double zenith = 1.0;   ///< z; 1: no more of them there
  double horizon = 0.0;  ///< f; 0: no more of them there

  [[nodiscard]] bool crowd() const noexcept { return zenith < 1.0 || horizon > 0.0; }
};

/// Coefficients of the suns' coordinate.
struct SunTerms {
  double bend;
  double path;
  double level;
  double lowest;  ///< sine of the elevation
  double sunset;
  double width;          ///< w
  double centre;         ///< c
  double sunset_lowest;  ///< s(lowest)
  double zenith;         ///< z of suns
};

/// Coefficients of q; sines of the sun's elevation.
struct AzimuthTerms {
  double most;
  double middle;
  double width;
  double deep;
  double start;
  double rise;
};

/// Share of the suns' coordinate in which high suns' nodes are bent.
inline constexpr double kHighSuns = 0.19;

class TableMapping {
 public:
  /// Radii in metres; the sine of the lowest sun's elevation; the angular radius of its disc (the Earth's sun's).
  TableMapping(double bottom_radius, double top_radius, double lowest_sun_sine, double sun_radius_degrees = 0.2678,
               TableNodes nodes = {}) noexcept;

  [[nodiscard]] double bottom_radius() const noexcept { return bottom_; }
  /// Returns whether there is so little air that views' coordinates are bent.
  [[nodiscard]] bool thin() const noexcept { return view_bend_ > 0.0; }
  [[nodiscard]] double view_bend() const noexcept { return view_bend_; }  ///< b; 0: not bent
  [[nodiscard]] const ViewTerms& view_terms() const noexcept { return view_terms_; }
  [[nodiscard]] double thickness() const noexcept { return thickness_; }
  [[nodiscard]] double top_tangent() const noexcept { return top_tangent_; }  ///< H

  /// Altitudes from 0 to the thickness; others count as the nearest.
  [[nodiscard]] double height_coordinate(double altitude) const noexcept;
  [[nodiscard]] double altitude(double coordinate) const noexcept;

  /// Position among `zeniths` (even) nodes of a ray that ends on the ground or does not: at the horizon both are right.
  [[nodiscard]] double view_position(double altitude, double zenith_cosine, bool ground, int zeniths) const noexcept;
  /// Positions up to zeniths / 2 - 1 are rays to the ground, from zeniths / 2 on rays to the top.
  [[nodiscard]] Ray view_ray(double altitude, double position, int zeniths) const noexcept;

  /// Rays to the top; one below the horizon counts as the horizon's.
  [[nodiscard]] double transmittance_coordinate(double altitude, double zenith_cosine) const noexcept;
  [[nodiscard]] Ray transmittance_ray(double altitude, double coordinate) const noexcept;

  /// Suns below the lowest count as the lowest.
  [[nodiscard]] double sun_coordinate(double sun_zenith_cosine) const noexcept;
  /// By bisection: takes microseconds.
  [[nodiscard]] double sun_zenith_cosine(double coordinate) const noexcept;
  [[nodiscard]] const SunTerms& sun_terms() const noexcept { return sun_terms_; }

  /// The coordinate without the nodes for the disc, whose setting does not show in light that was scattered before.
  [[nodiscard]] double smooth_sun_coordinate(double sun_zenith_cosine) const noexcept;
  [[nodiscard]] double smooth_sun_zenith_cosine(double coordinate) const noexcept;
  [[nodiscard]] const SunTerms& smooth_sun_terms() const noexcept { return smooth_sun_terms_; }

  [[nodiscard]] double lowest_sun() const noexcept { return lowest_; }  ///< A

  /// The top that suns' paths are measured to, metres above the ground, and its H.
  [[nodiscard]] double sun_thickness() const noexcept { return sun_thickness_; }
  [[nodiscard]] double sun_tangent() const noexcept { return sun_tangent_; }

  /// Returns q under that sun.
  [[nodiscard]] double azimuth_bend(double sun_zenith) const noexcept;
  [[nodiscard]] const AzimuthTerms& azimuth_terms() const noexcept { return azimuth_terms_; }
  /// Returns the coordinate of the azimuth's cosine; one beyond 1 counts as 1.
  [[nodiscard]] double azimuth_coordinate(double azimuth_cosine, double sun_zenith) const noexcept {
    return bent_azimuth(azimuth_cosine, azimuth_bend(sun_zenith));
  }
  /// Returns the coordinate of the azimuth's cosine, given q.
  [[nodiscard]] static double bent_azimuth(double azimuth_cosine, double bend) noexcept;
  [[nodiscard]] double azimuth_cosine(double coordinate, double sun_zenith) const noexcept;

  /// nu = mu mu_s + sqrt(1 - mu^2) sqrt(1 - mu_s^2) cos phi.
  [[nodiscard]] double angle_cosine(double view_zenith, double sun_zenith, double coordinate) const noexcept;

 private:
  [[nodiscard]] double scaled_sun_distance(double sun_zenith_cosine) const noexcept;
  [[nodiscard]] double coordinate_of_sun(const SunTerms& terms, double sun_zenith_cosine) const noexcept;
  [[nodiscard]] double sun_at(const SunTerms& terms, double coordinate) const noexcept;
  [[nodiscard]] double ground_coordinate(double altitude, double zenith_cosine) const noexcept;
  [[nodiscard]] Ray ground_ray(double altitude, double coordinate) const noexcept;

  double bottom_;
  double thickness_;
  double top_tangent_;
  double view_bend_;
  ViewTerms view_terms_;
  double sun_thickness_;
  double sun_tangent_;
  double lowest_;  ///< a of the lowest sun
  SunTerms smooth_sun_terms_;
  SunTerms sun_terms_;
  AzimuthTerms azimuth_terms_;
};

}  // namespace welkin::sky
