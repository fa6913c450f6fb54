#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "jobs/tiles.h"
#include "sky/check_sky_arguments.h"
#include "sky/sky_geometry.h"
#include "sky/sky_quadrature.h"
#include "welkin/error.h"
#include "welkin/sky_reference.h"

namespace welkin {
namespace {

/// A ring of equal zenith angles.
struct Ring {
  double cosine = 0.0;
  double sine = 0.0;
  double weight = 0.0;
};

std::vector<Ring> rings_of(const sky::SkyRule& rule) {
  std::vector<Ring> rings;
  for (const sky::RingRule* side : {&rule.above, &rule.below}) {
    for (std::size_t k = 0; k < side->cosines.size(); ++k) {
      rings.push_back({side->cosines[k], side->sines[k], side->weights[k]});
    }
  }
  return rings;
}

/// Horizontal, towards the sun; towards +z for one in the zenith or nadir.
glm::dvec3 ahead_of(const glm::dvec3& sun) {
  const double length = std::sqrt(sun.x * sun.x + sun.z * sun.z);
  return length > 0.0 ? glm::dvec3(sun.x / length, 0.0, sun.z / length) : glm::dvec3(0.0, 0.0, 1.0);
}

void check(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& sun) {
  check(atmosphere);
  sky::check_altitude(altitude_m);
  sky::check_direction("the sun's direction", sun);
  if (atmosphere.wavelengths_nm.size() == 3) return;
  throw Error(ErrorCode::invalid_argument, "the atmosphere has " + std::to_string(atmosphere.wavelengths_nm.size()) +
                                               " wavelengths; harmonics in three channels need three");
}

}  // namespace

SphericalHarmonics reference_sky_harmonics(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& sun,
                                           const ReferenceHarmonicsOptions& options, const Control& control) {
  check(atmosphere, altitude_m, sun);
  const SkyHarmonicsOptions places{options.bands, SkyQuadrature::gauss_split, options.zeniths, options.azimuths};
  const double radius = atmosphere.bottom_radius_m;
  const double horizon = sky::horizon_cosine(radius, altitude_m);
  // From space the highest ring that has any light is the air's upper edge.
  const double above = altitude_m - (atmosphere.top_radius_m - radius);
  const double top = above > 0.0 ? sky::horizon_cosine(atmosphere.top_radius_m, above) : 1.0;
  const sky::SkyRule rule = sky::sky_rule(places, horizon, top, atmosphere.aerosol_asymmetry);
  const std::vector<Ring> rings = rings_of(rule);
  const glm::dvec3 ahead = ahead_of(sun);
  const glm::dvec3 aside(ahead.z, 0.0, -ahead.x);
  const auto count = static_cast<std::size_t>(options.bands * options.bands);
  std::vector<SphericalHarmonics> sums(rings.size(), SphericalHarmonics(options.bands));
  const jobs::Placement placement = jobs::Placement::arena;
  jobs::run_tiles(rings.size(), placement, jobs::worker_count(placement), control, [&](std::size_t k, std::size_t) {
    const Ring& ring = rings[k];
    std::vector<double> basis(count);
    for (std::size_t i = 0; i < rule.azimuths.cosines.size(); ++i) {
      const double sine = std::sqrt(rule.azimuths.from_sun[i] * rule.azimuths.from_opposite[i]);
      const glm::dvec3 along = glm::dvec3(0.0, ring.cosine, 0.0) + ring.sine * rule.azimuths.cosines[i] * ahead;
      const glm::dvec3 across = ring.sine * sine * aside;
      const std::vector<double> light =
          reference_sky_radiance(atmosphere, altitude_m, along + across, sun, options.radiance);
      const double weight = 0.5 * ring.weight * rule.azimuths.weights[i];
      for (const glm::dvec3& direction : {along + across, along - across}) {
        evaluate_basis(direction, options.bands, basis);
        for (std::size_t c = 0; c < count; ++c) {
          sums[k].coefficients()[c] += weight * basis[c] * glm::dvec3(light[0], light[1], light[2]);
        }
      }
    }
  });
  SphericalHarmonics total(options.bands);
  for (const SphericalHarmonics& sum : sums) {
    for (std::size_t c = 0; c < count; ++c) total.coefficients()[c] += sum.coefficients()[c];
  }
  return total;
}

}  // namespace welkin
