// Promise: a shell of air that is thin against its planet does not make light, whatever the sun's elevation.
#include <cmath>
#include <memory>
#include <numbers>

#include "sky/table_mapping.h"
#include "support/catch.h"
#include "tables/gauss_legendre.h"
#include "welkin/sky_view.h"

namespace welkin::test {
namespace {

using std::numbers::pi;

/// Molecules that absorb nothing, evenly through a shell of 1 km, over ground that reflects all.
Atmosphere shell(double radius_m, double depth) {
  constexpr double thickness_m = 1000.0;
  Atmosphere air;
  air.bottom_radius_m = radius_m;
  air.top_radius_m = radius_m + thickness_m;
  air.rayleigh.density = {{.constant_term = 1.0}};
  air.rayleigh.scattering_per_m.assign(3, depth / thickness_m);
  air.solar_irradiance = {1.0, 1.0, 1.0};
  return with_ground_albedo(air, 1.0);
}

/// W/m2 that go up through the top.
double flux_up(const SkyView& top, const glm::dvec3& sun) {
  constexpr int azimuths = 24;
  const simd::GaussRule rule = tables::gauss_legendre(16);
  double flux = 0.0;
  for (int i = 0; i < 16; ++i) {
    const double cosine = 0.5 + 0.5 * rule.nodes[i];
    const double sine = std::sqrt(1.0 - cosine * cosine);
    for (int k = 0; k < azimuths; ++k) {
      const double azimuth = 2.0 * pi * (k + 0.5) / azimuths;
      const glm::dvec3 down(sine * std::sin(azimuth), -cosine, sine * std::cos(azimuth));
      flux += 0.5 * rule.weights[i] * cosine * 2.0 * pi / azimuths * top.radiance(down, sun)[1];
    }
  }
  return flux;
}

}  // namespace

TEST_CASE("A thin shell over white ground sends back what comes in to 2 %", "[sky][tables][view]") {
  SkyTableOptions options;
  options.heights = 8;
  options.orders = 8;
  for (const double radius_m : {6.36e6, 6.36e7}) {
    const auto tables = std::make_shared<const SkyTables>(precompute_sky(shell(radius_m, 0.1), options));
    const SkyView top(tables, 1000.0);
    for (const double elevation : {90.0, 60.0, 45.0, 25.0, 10.0}) {
      const glm::dvec3 sun = sun_direction(elevation, 0.0);
      CAPTURE(radius_m, elevation);
      CHECK(std::abs(flux_up(top, sun) / sun.y - 1.0) < 0.02);
    }
  }
}

// Of a shell of 1/60000 of the radius the whole day would lie in one of 63 intervals.
TEST_CASE("Suns of a day are spread over nodes however thin the air is", "[sky][mapping]") {
  for (const double thickness : {0.06, 1.0, 1000.0, 60'000.0, 6e6}) {
    const sky::TableMapping mapping(6.36e6, 6.36e6 + thickness, -0.5);
    CAPTURE(thickness);
    CHECK(mapping.sun_coordinate(0.5) < 0.95);
    CHECK(mapping.sun_coordinate(0.1) < 0.75);
    for (const double cosine : {1.0, 0.5, 0.1, 0.0, -0.2}) {
      CHECK(std::abs(mapping.sun_zenith_cosine(mapping.sun_coordinate(cosine)) - cosine) < 1e-9);
    }
  }
}

}  // namespace welkin::test
