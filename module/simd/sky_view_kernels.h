// Looking up a sky: what the kernels take.
#pragma once

#include <cstdint>

namespace welkin::simd {

/// A row of a slice: Rayleigh's and higher orders' red, green, blue, 0; the aerosol's red, green, blue, 0.
inline constexpr int kSkyRow = 8;
/// Colours at the ends of rays: red, green, blue, 0.
inline constexpr int kSkyColour = 4;

/// Weights of the cubic through four nodes next to each other, at 0 <= x <= 3.
struct CubicTaps {
  std::int32_t first;
  std::int32_t between;  ///< the position lies between this and the next of the four: 0 to 2
  float weights[4];
};

/// One slice and one sun. Lengths in metres, all in double: planets have 1e9 of them, and altitudes of one.
struct SkyRun {
  // The point from which the slice is seen: the viewer's, or, of one above the air, any point of the top.
  double bottom;       ///< R
  double radius;       ///< r
  double altitude;     ///< h
  double rho_squared;  ///< h (2 R + h)
  double shell;        ///< (T - h) (2 R + T + h)
  double shortest;     ///< T - h
  double to_sky;       ///< positions a metre of distance to the top beyond the shortest
  double to_ground;    ///< positions a metre of distance to the ground beyond h

  bool outside;          ///< the viewer is above the air
  double viewer_radius;  ///< then

  double sun[3];      ///< unit
  double sun_zenith;  ///< mu_s = sun[1]
  double sun_sine;    ///< sqrt(sun[0]^2 + sun[2]^2)

  // Suns' nodes, for views from outside, whose rays come in each under another sun.
  double sun_tangent_squared;  ///< H^2 of the top that suns' paths are measured to
  double sun_thickness;        ///< its T
  double sun_scale;            ///< 1 / (H - T)
  double lowest_sun;           ///< a of the lowest
  double lowest_zenith;        ///< its mu_s
  CubicTaps sun_taps;          ///< from inside
  float fade;

  int half;  ///< nodes of either half of the views: first those that end on the ground
  int azimuths;
  int suns;
  const float* rows;    ///< [2 half][azimuths][suns][kSkyRow]
  const float* of_sun;  ///< `reduce_sky` of them, or null: then it is done on the way

  bool henyey_greenstein;
  double asymmetry;      ///< g
  double aerosol_scale;  ///< what does not depend on the angle

  const float* reach;   ///< [half][kSkyColour]: transmittance up to the ground; null: rays to the ground see none
  const float* ground;  ///< [grounds][kSkyColour]: radiance of the ground over sqrt|mu_s| with its sign
  int grounds;
};

/// of_sun[2 half][azimuths][kSkyRow] = the rows weighted by the sun's taps.
using ReduceSky = void (*)(const SkyRun& run, float* of_sun);

/// Radiance from each of `count` directions x y z, which need not be of unit length (the origin counts as up).
using SkyRadiance = void (*)(const SkyRun& run, const double* directions, int count, float* rgb);

struct SkyViewKernels {
  ReduceSky reduce;
  SkyRadiance radiance;
};

}  // namespace welkin::simd
