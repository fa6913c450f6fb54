// The truth that fast skies are measured against: slow, in double, by other routes than the tables. The model is that
// of all skies, as welkin/sky.h states it; light scattered more than once is in sky_monte_carlo.h.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Transmittance at each of the wavelengths from an altitude along a direction whose cosine with the zenith is
/// `zenith_cosine`, to the top of the atmosphere; 0 if the ground is in the way. Relative error of the optical
/// depth below 1e-9. `altitude_m` is 0 to 1e9 (above the top: space).
[[nodiscard]] std::vector<double> reference_transmittance(const Atmosphere& atmosphere, double altitude_m,
                                                          double zenith_cosine);

struct ReferenceSkyOptions {
  /// Of the integral along the ray, 1e-10 to 1e-1. Its pieces are halved until it is met or 4000 have been, which no
  /// atmosphere in the tests comes near to.
  double relative_error = 1e-6;
  bool ground = true;  ///< light of the ground where a ray ends there: direct sun only
};

/// Singly scattered sunlight that arrives from `direction` at `altitude_m` (0 to 1e9, space included), at each of the
/// wavelengths: W/m2/sr/nm. The sun's disc is left out. `direction` and `sun` (towards it) are unit vectors within
/// 1e-6. Some 0.1 to 1 ms for the Earth.
[[nodiscard]] std::vector<double> reference_sky_radiance(const Atmosphere& atmosphere, double altitude_m,
                                                         const glm::dvec3& direction, const glm::dvec3& sun,
                                                         const ReferenceSkyOptions& options = {});

struct ReferenceHarmonicsOptions {
  int bands = 3;      ///< 1 to kMaximumBands
  int zeniths = 40;   ///< on either side of the horizon, 2 to 128
  int azimuths = 32;  ///< over half the circle, closer together about the sun; mirrored: 2 to 256
  ReferenceSkyOptions radiance{};
};

/// Radiance coefficients of singly scattered sunlight, without the sun's disc: `reference_sky_radiance` integrated ring
/// by ring with the places and weights of `SkyQuadrature::gauss_split`, nothing taken out. What tables and projectors
/// are measured against. Of the Earth's nine at the default setting 1e-5 by day, 1e-4 in twilight (against twice as
/// many places). Cost: 2 zeniths azimuths radiances, in the caller's arena. The same bits on any number of threads. Of
/// three wavelengths.
[[nodiscard]] SphericalHarmonics reference_sky_harmonics(const Atmosphere& atmosphere, double altitude_m,
                                                         const glm::dvec3& sun,
                                                         const ReferenceHarmonicsOptions& options = {});

/// Irradiance of the direct sun on a surface that faces it, at each of the wavelengths: W/m2/nm.
[[nodiscard]] std::vector<double> reference_sun_irradiance(const Atmosphere& atmosphere, double altitude_m,
                                                           const glm::dvec3& sun);

}  // namespace welkin
