// The reference for fast skies: slow, in double, by other routes than the tables. The model is that of all skies, as
// welkin/sky.h states it; sky_monte_carlo.h covers light that is scattered more than once.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Returns the transmittance at each wavelength from an altitude along a direction whose cosine with the zenith is
/// `zenith_cosine`, to the top of the atmosphere; 0 if the ground is in the way. The optical depth's relative error is
/// below 1e-9. `altitude_m` is 0 to 1e9 (above the top: space).
[[nodiscard]] std::vector<double> reference_transmittance(const Atmosphere& atmosphere, double altitude_m,
                                                          double zenith_cosine);

struct ReferenceSkyOptions {
  /// Relative error of the integral along the ray, 1e-10 to 1e-1. Pieces are halved until it is met, or 4000 times at
  /// most, which no atmosphere in the tests comes near.
  double relative_error = 1e-6;
  bool ground = true;  ///< whether to add the ground's light where a ray ends there: direct sun only
};

/// Returns the singly scattered sunlight that arrives from `direction` at `altitude_m` (0 to 1e9, space included), at
/// each wavelength, without the sun's disc: W/m2/sr/nm. `direction` and `sun` (towards it) are unit vectors within
/// 1e-6. Takes 0.1 to 1 ms for the Earth.
[[nodiscard]] std::vector<double> reference_sky_radiance(const Atmosphere& atmosphere, double altitude_m,
                                                         const glm::dvec3& direction, const glm::dvec3& sun,
                                                         const ReferenceSkyOptions& options = {});

struct ReferenceHarmonicsOptions {
  int bands = 3;      ///< 1 to kMaximumBands
  int zeniths = 40;   ///< on either side of the horizon, 2 to 128
  int azimuths = 32;  ///< over half the circle, closer together about the sun; mirrored: 2 to 256
  ReferenceSkyOptions radiance{};
};

/// Returns radiance coefficients of singly scattered sunlight at three wavelengths, without the sun's disc: the
/// reference for tables and projectors. Integrates `reference_sky_radiance` ring by ring with the nodes and weights of
/// `SkyQuadrature::gauss_split`, nothing subtracted. Error of the Earth's nine at the default setting (against twice as
/// many nodes): 1e-5 by day, 1e-4 in twilight. Costs 2 zeniths azimuths radiances, in the caller's arena. Bit-identical
/// on any number of threads.
[[nodiscard]] SphericalHarmonics reference_sky_harmonics(const Atmosphere& atmosphere, double altitude_m,
                                                         const glm::dvec3& sun,
                                                         const ReferenceHarmonicsOptions& options = {});

/// Returns the irradiance of the direct sun on a surface that faces it, at each wavelength: W/m2/nm.
[[nodiscard]] std::vector<double> reference_sun_irradiance(const Atmosphere& atmosphere, double altitude_m,
                                                           const glm::dvec3& sun);

}  // namespace welkin
