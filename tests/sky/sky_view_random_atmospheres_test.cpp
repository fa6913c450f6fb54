// Nothing that is not finite, nothing below zero: any planet, any height, any sun.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "sky/sky_tables_for_tests.h"
#include "support/catch.h"
#include "support/random_atmospheres.h"
#include "welkin/sky_reference.h"
#include "welkin/sky_view.h"

namespace welkin::test {
namespace {

bool sound(const glm::dvec3& rgb) {
  bool result = true;
  for (int c = 0; c < 3; ++c) result = result && std::isfinite(rgb[c]) && rgb[c] >= 0.0;
  return result;
}

/// Smallest tables with anything in them, some with fewer nodes than a cubic takes.
SkyTableOptions tiny(RandomAtmospheres& random) {
  SkyTableOptions options;
  options.layout = random.chance(0.3) ? ScatteringLayout::compact : ScatteringLayout::full;
  options.heights = random.whole(2, 5);
  options.view_zeniths = 2 * random.whole(2, 5);
  options.sun_zeniths = random.whole(4, 8);
  options.sun_angles = random.whole(2, 5);
  options.transmittance_heights = random.whole(2, 6);
  options.transmittance_zeniths = random.whole(4, 16);
  options.irradiance_heights = random.whole(2, 4);
  options.irradiance_sun_zeniths = random.whole(4, 8);
  options.orders = 1;
  return options;
}

}  // namespace

TEST_CASE("sky view: random atmospheres look finite and not negative", "[sky][view][random]") {
  RandomAtmospheres random(20'261'121);
  for (int i = 0; i < trials(400); ++i) {
    const Atmosphere air = random.next();
    const auto tables = std::make_shared<const SkyTables>(precompute_sky(air, tiny(random)));
    const double thickness = air.top_radius_m - air.bottom_radius_m;
    for (const double altitude :
         {0.0, std::min(1e9, 1e-9 * thickness), std::min(1e9, random.number() * thickness), std::min(1e9, thickness),
          std::min(1e9, thickness * (1.0 + 1e-12)), std::min(1e9, 10.0 * air.bottom_radius_m)}) {
      CAPTURE(i, altitude, air.bottom_radius_m, thickness);
      const SkyView view(tables, altitude);
      bool all = true;
      for (int k = 0; k < 60; ++k) {
        const double elevation = k < 10 ? 90.0 - 20.0 * k : random.between(-90.0, 90.0);
        const glm::dvec3 sun = sun_direction(elevation, random.between(0.0, 360.0));
        const glm::dvec3 towards =
            k % 7 == 0   ? sun
            : k % 7 == 1 ? -sun
                         : sun_direction(random.chance(0.3) ? random.between(-1e-6, 1e-6) : random.between(-90.0, 90.0),
                                         random.between(0.0, 360.0));
        all = all && sound(view.radiance(towards, sun)) && sound(view.sun(sun).irradiance) &&
              sound(view.sun(sun).radiance) && sound(view.irradiance(sun));
      }
      CHECK(all);
    }
  }
}

TEST_CASE("sky view: the compact table looks much like the full one", "[sky][view]") {
  const glm::dvec3 sun = sun_direction(30.0, 0.0);
  const SkyView full(small_view_tables(), 0.0);
  const SkyView compact(small_tables(earth(), ScatteringLayout::compact), 0.0);
  for (const glm::dvec3& towards : {glm::dvec3(0, 1, 0), glm::dvec3(0.6, 0.5, 0.3), glm::dvec3(-0.5, 0.2, 0.1)}) {
    const glm::dvec3 a = full.radiance(towards, sun);
    const glm::dvec3 b = compact.radiance(towards, sun);
    for (int c = 0; c < 3; ++c) CHECK(b[c] == Approx(a[c]).epsilon(0.06));
  }
}

TEST_CASE("sky view: folded colours are the folded truth", "[sky][view][truth]") {
  const Atmosphere air = earth({400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0});
  SkyTableOptions options;
  options.heights = 4;
  options.view_zeniths = 32;
  options.sun_zeniths = 32;
  options.orders = 1;
  options.colour = SkyColour::linear_srgb;
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(air, options)), 0.0);
  const std::vector<glm::dvec3> weights = srgb_weights(air.wavelengths_nm);
  const auto folded = [&](const std::vector<double>& values) {
    glm::dvec3 sum{};
    for (std::size_t i = 0; i < values.size(); ++i) sum += weights[i] * values[i];
    return sum;
  };
  for (const double elevation : {60.0, 10.0}) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    for (const glm::dvec3& towards :
         {glm::dvec3(0, 1, 0), glm::dvec3(0.6, 0.529, 0.6), glm::dvec3(-0.8, 0.2, -0.565)}) {
      const glm::dvec3 unit = glm::normalize(towards);
      const glm::dvec3 truth = folded(reference_sky_radiance(air, 0.0, unit, sun, {1e-6, true}));
      const glm::dvec3 found = view.radiance(unit, sun);
      for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(std::max(truth[c], 0.0)).epsilon(0.005));
    }
    const glm::dvec3 light = folded(reference_sun_irradiance(air, 0.0, sun));
    for (int c = 0; c < 3; ++c) CHECK(view.sun(sun).irradiance[c] == Approx(light[c]).epsilon(0.002));
  }
}

TEST_CASE("sky view: the sun comes through the air as in the reference", "[sky][view][truth]") {
  for (const double altitude : {0.0, 5000.0, 70'000.0, 400'000.0}) {
    const SkyView view(single_tables(), altitude);
    for (const double elevation : {90.0, 30.0, 5.0, 1.0, -2.0, -12.0}) {
      const glm::dvec3 sun = sun_direction(elevation, 0.0);
      const std::vector<double> truth = reference_sun_irradiance(earth(), altitude, sun);
      for (int c = 0; c < 3; ++c) {
        CAPTURE(altitude, elevation, c);
        CHECK(view.sun(sun).irradiance[c] == Approx(truth[static_cast<std::size_t>(c)]).epsilon(0.003).margin(1e-6));
      }
    }
  }
}

}  // namespace welkin::test
