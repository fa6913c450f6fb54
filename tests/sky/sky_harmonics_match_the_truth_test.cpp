// Promise: with nothing but defaults a sky's nine coefficients are within 0.5 % of the truth, tables, view and
// quadrature or curve together, for suns from the zenith to 6 degrees below the horizon.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "sky/sky_quadrature.h"
#include "support/catch.h"
#include "support/small_skies.h"
#include "welkin/sky_harmonics.h"
#include "welkin/sky_reference.h"

namespace welkin::test {
namespace {

/// Ray by ray, in double, on the ground: below the horizon there is black ground alone.
SphericalHarmonics truth(const Atmosphere& air, const glm::dvec3& sun) {
  const sky::SkyRule rule = sky::sky_rule({.zeniths = 20, .azimuths = 12}, 0.0, 1.0, air.aerosol_asymmetry);
  SphericalHarmonics sum(3);
  std::array<double, 9> basis{};
  for (std::size_t k = 0; k < rule.above.cosines.size(); ++k) {
    for (std::size_t i = 0; i < rule.azimuths.cosines.size(); ++i) {
      const double across = rule.above.sines[k] * std::sqrt(rule.azimuths.from_sun[i] * rule.azimuths.from_opposite[i]);
      const double ahead = rule.above.sines[k] * rule.azimuths.cosines[i];
      const std::vector<double> light =
          reference_sky_radiance(air, 0.0, {across, rule.above.cosines[k], ahead}, sun, {.relative_error = 1e-4});
      for (const double side : {1.0, -1.0}) {
        evaluate_basis({side * across, rule.above.cosines[k], ahead}, 3, basis);
        const double weight = 0.5 * rule.above.weights[k] * rule.azimuths.weights[i];
        for (std::size_t c = 0; c < 9; ++c) {
          sum.coefficients()[c] += weight * basis[c] * glm::dvec3(light[0], light[1], light[2]);
        }
      }
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("defaults are within 0.5 % of the truth from 90 to -6 degrees", "[sky][harmonics][truth]") {
  const Atmosphere air = with_ground_albedo(earth(), 0.0);
  SkyTableOptions options;
  options.orders = 1;
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(air, options)), 0.0);
  const SkyProjector projector(view);
  const SkyCurve curve(view);
  for (const double elevation : {90.0, 45.0, 10.0, 2.0, 0.0, -2.0, -4.0, -6.0}) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    const SphericalHarmonics expected = truth(air, sun);
    CHECK(relative_difference(projector.project(sun).coefficients(), expected.coefficients()) < 5e-3);
    CHECK(relative_difference(curve.at(sun).coefficients(), expected.coefficients()) < 5e-3);
  }
}

}  // namespace welkin::test
