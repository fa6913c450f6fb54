// The truth that fast skies are measured against: slow, in double, by other routes than the tables.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "welkin/atmosphere.h"
#include "welkin/control.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

/// The model of all of Welkin's skies, tables included:
/// - Light propagates along straight lines in spherical shells. Sunlight at a point x is solar irradiance times
///   transmittance from x towards the sun's centre, or towards the horizon if the centre is below it, times the visible
///   share of the disc, v(t) = t^2 (3 - 2 t) with t = clamp((e + a) / 2a, 0, 1), e = (mu_s - mu_h) r / R the elevation
///   of the centre over x's own horizon in radians, nearly (mu_s: cosine between zenith and sun; mu_h = -sqrt(1 -
///   (R/r)^2); R: the ground's radius, r: x's), a the sun's angular radius in radians. Of a point (a = 0) 1 above the
///   horizon, else 0. (Bruneton 2017, GetTransmittanceToSun.)
/// - For scattering its direction is that of the centre.
/// - The ground is Lambertian.

/// Transmittance at each of the wavelengths from an altitude along a direction whose cosine with the zenith is
/// `zenith_cosine`, to the top of the atmosphere; 0 if the ground is in the way. Relative error of the optical
/// depth below 1e-9. `altitude_m` is 0 to 1e9 (above the top: space). Throws `Error` (invalid_argument).
[[nodiscard]] std::vector<double> reference_transmittance(const Atmosphere& atmosphere, double altitude_m,
                                                          double zenith_cosine);

struct ReferenceSkyOptions {
  /// Of the integral along the ray, 1e-10 to 1e-1. Its pieces are halved until it is met or 4000 have been, which no
  /// atmosphere in the tests comes near to.
  double relative_error = 1e-6;
  bool ground = true;  ///< light of the ground where a ray ends there: direct sun only
};

/// Singly scattered sunlight that arrives from `direction` at `altitude_m` (0 to 1e9, space included), at each of the
/// wavelengths: W/m2/sr/nm. The sun's disc is apart. `direction` and `sun` (towards it) are unit vectors within 1e-6.
/// Some 0.1 to 1 ms for the Earth. Throws `Error` (invalid_argument).
[[nodiscard]] std::vector<double> reference_sky_radiance(const Atmosphere& atmosphere, double altitude_m,
                                                         const glm::dvec3& direction, const glm::dvec3& sun,
                                                         const ReferenceSkyOptions& options = {});

struct ReferenceHarmonicsOptions {
  int bands = 3;      ///< 1 to kMaximumBands
  int zeniths = 40;   ///< on either side of the horizon, 2 to 128
  int azimuths = 32;  ///< over half the circle, closer together about the sun; mirrored: 2 to 256
  ReferenceSkyOptions radiance{};
};

/// Radiance coefficients of singly scattered sunlight, disc apart: `reference_sky_radiance` integrated ring by ring
/// with the places and weights of `SkyQuadrature::gauss_split`, nothing taken out. What tables and projectors are
/// measured against. Of the Earth's nine at the default setting 1e-5 by day, 1e-4 in twilight (against twice as many
/// places). Cost: 2 zeniths azimuths radiances, in the caller's arena. The same bits on any number of threads. Throws
/// `Error`: invalid_argument (also for other than three wavelengths), cancelled.
[[nodiscard]] SphericalHarmonics reference_sky_harmonics(const Atmosphere& atmosphere, double altitude_m,
                                                         const glm::dvec3& sun,
                                                         const ReferenceHarmonicsOptions& options = {},
                                                         const Control& control = {});

/// Irradiance of the direct sun on a surface that faces it, at each of the wavelengths: W/m2/nm. Throws `Error`
/// (invalid_argument).
[[nodiscard]] std::vector<double> reference_sun_irradiance(const Atmosphere& atmosphere, double altitude_m,
                                                           const glm::dvec3& sun);

struct PathTracingOptions {
  int lowest_order = 2;   ///< scatterings and ground reflections together, 1 to 64: 1 is singly scattered light
  int highest_order = 4;  ///< `lowest_order` to 64
  std::int64_t paths =
      1'000'000;  ///< 2 to 1e12; for the Earth at three wavelengths some 3 microseconds each, on one core
  std::uint64_t seed = 1;
};

/// Estimates with their standard errors.
struct TracedHarmonics {
  int bands = 0;
  std::vector<std::vector<double>> radiance;  ///< [wavelength][bands^2], canonical order
  std::vector<std::vector<double>>
      standard_error;  ///< likewise: from how the means of 64 or more parts of the paths differ
};

/// Spherical harmonics of the light of the orders asked for, by path tracing backwards from `altitude_m` with
/// next-event estimation towards the sun: unbiased (but for optical depths by quadrature, 1e-5 of them), independent of
/// every table. The same bits on any number of threads. Of the Earth's orders 2 to 4, a million paths give band 0 to
/// 0.3 % at noon and 2.5 % at -4 degrees; below -8 hardly any finds light. Throws `Error`: invalid_argument, cancelled.
[[nodiscard]] TracedHarmonics trace_sky_harmonics(const Atmosphere& atmosphere, double altitude_m,
                                                  const glm::dvec3& sun, int bands,
                                                  const PathTracingOptions& options = {}, const Control& control = {});

}  // namespace welkin
