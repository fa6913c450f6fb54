// Singly scattered skies against the dense truth in double precision.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "sky/sky_geometry.h"
#include "sky/sky_tables_for_tests.h"
#include "support/catch.h"
#include "welkin/sky_reference.h"
#include "welkin/sky_view.h"

namespace welkin::test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Errors {
  double rms = 0.0;        ///< relative, by solid angle
  double harmonics = 0.0;  ///< of the first nine coefficients
  double largest = 0.0;    ///< of the brightest
};

/// Real harmonics of bands 0 to 2 about the zenith, the plane of the sun being x = 0.
std::vector<double> nine(const glm::dvec3& d) {
  return {0.282094791773878,
          0.488602511902920 * d.y,
          0.488602511902920 * d.z,
          1.092548430592079 * d.y * d.z,
          0.315391565252520 * (3.0 * d.y * d.y - 1.0),
          0.546274215296040 * (d.z * d.z - d.x * d.x)};
}

/// Directions on both sides of the horizon, denser towards it; half the azimuths, as the other half is the mirror
/// image.
Errors errors_of(const SkyView& view, double altitude, double elevation) {
  const Atmosphere& air = view.tables()->atmosphere;
  const glm::dvec3 sun = sun_direction(elevation, 0.0);
  const double horizon = sky::horizon_cosine(air.bottom_radius_m, altitude);
  const double thickness = air.top_radius_m - air.bottom_radius_m;
  const double highest = altitude > thickness ? sky::horizon_cosine(air.top_radius_m, altitude - thickness) : 1.0;
  constexpr int zeniths = 8;
  constexpr int azimuths = 4;
  double difference = 0.0;
  double whole = 0.0;
  double largest = 0.0;
  double brightest = 0.0;
  std::vector<double> found(18);
  std::vector<double> expected(18);
  for (int side = 0; side < 2; ++side) {
    const double reach = side == 0 ? highest - horizon : 1.0 + horizon;
    for (int i = 0; i < zeniths; ++i) {
      const double q = (i + 0.5) / zeniths;
      const double mu = side == 0 ? horizon + reach * q * q : horizon - reach * q * q;
      for (int j = 0; j < azimuths; ++j) {
        const double azimuth = kPi * (j + 0.37) / azimuths;
        const double sine = std::sqrt(1.0 - mu * mu);
        const glm::dvec3 towards(sine * std::sin(azimuth), mu, sine * std::cos(azimuth));
        const glm::dvec3 sky = view.radiance(towards, sun);
        const std::vector<double> truth = reference_sky_radiance(air, altitude, towards, sun, {1e-5, true});
        const double weight = reach * 2.0 * q / zeniths * 2.0 * kPi / azimuths;
        const std::vector<double> basis = nine(towards);
        for (int c = 0; c < 3; ++c) {
          const double exact = truth[static_cast<std::size_t>(c)];
          difference += weight * (sky[c] - exact) * (sky[c] - exact);
          whole += weight * exact * exact;
          largest = std::max(largest, std::abs(sky[c] - exact));
          brightest = std::max(brightest, exact);
          for (std::size_t k = 0; k < basis.size(); ++k) {
            found[3 * k + static_cast<std::size_t>(c)] += weight * basis[k] * sky[c];
            expected[3 * k + static_cast<std::size_t>(c)] += weight * basis[k] * exact;
          }
        }
      }
    }
  }
  double off = 0.0;
  double size = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    off += (found[k] - expected[k]) * (found[k] - expected[k]);
    size += expected[k] * expected[k];
  }
  return {std::sqrt(difference / whole), std::sqrt(off / size), largest / brightest};
}

}  // namespace

TEST_CASE("sky view: a singly scattered sky is the truth to half a percent", "[sky][view][truth]") {
  for (const double altitude : {0.0, 2000.0, 20'000.0}) {
    const SkyView view(single_tables(), altitude);
    for (const double elevation : {90.0, 30.0, 5.0, 0.0, -2.0, -6.0}) {
      CAPTURE(altitude, elevation);
      const Errors errors = errors_of(view, altitude, elevation);
      CHECK(errors.harmonics < 0.004);
      CHECK(errors.rms < (elevation > 2.0 ? 0.002 : 0.012));
      CHECK(errors.largest < (elevation > 2.0 ? 0.008 : 0.03));
    }
  }
}

TEST_CASE("sky view: from the top and from space too", "[sky][view][truth]") {
  for (const double altitude : {60'000.0, 300'000.0, 9.0 * 6'360'000.0}) {
    const SkyView view(single_tables(), altitude);
    for (const double elevation : {60.0, 5.0, -4.0}) {
      CAPTURE(altitude, elevation);
      const Errors errors = errors_of(view, altitude, elevation);
      CHECK(errors.harmonics < 0.005);
      CHECK(errors.rms < 0.02);
      CHECK(errors.largest < 0.04);
    }
  }
}

}  // namespace welkin::test
