// Promise: estimated errors of a sky's quadrature, table sizes and orders are at least the true ones, against far finer
// settings, in 99 % of random airs and suns, and what is picked meets its budget.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "estimates/budget.h"
#include "estimates/sky_probe.h"
#include "support/catch.h"
#include "support/honesty.h"
#include "support/random_atmospheres.h"
#include "support/small_skies.h"
#include "welkin/error_budget.h"

namespace welkin::test {
namespace {

using Lights = std::vector<SphericalHarmonics>;

/// Planets with air such as planets have: an Earth's sizes and depths, each off by up to several times.
Atmosphere varied_earth(RandomAtmospheres& random) {
  Atmosphere air = random.chance(0.3) ? mars() : earth();
  const double thicker = random.scale(0.2, 3.0);
  const double hazier = random.scale(0.1, 6.0);
  for (double& value : air.rayleigh.scattering_per_m) value *= thicker;
  for (double& value : air.aerosol.scattering_per_m) value *= hazier;
  for (double& value : air.aerosol.absorption_per_m) value *= hazier;
  air.aerosol_asymmetry = random.between(0.3, 0.95);
  for (double& value : air.ground_albedo) value = random.number();
  return air;
}

glm::dvec3 random_sun(RandomAtmospheres& random) {
  return sun_direction(random.chance(0.3) ? random.between(-6.0, 6.0) : random.between(-6.0, 90.0),
                       random.between(0.0, 360.0));
}

SkyTableOptions small_tables(int orders) {
  SkyTableOptions options = tiny_tables();
  options.view_zeniths = 32;
  options.sun_zeniths = 16;
  options.orders = orders;
  return options;
}

std::string text(const SkyHarmonicsOptions& setting) {
  return std::to_string(setting.zeniths) + " x " + std::to_string(setting.azimuths);
}

}  // namespace

TEST_CASE("Directions of a sky's harmonics are picked by finer ones", "[estimates][sky]") {
  RandomAtmospheres random(74);
  Honesty all("sky quadrature");
  Honesty picked("sky quadrature, picked");
  for (int trial = trials(8); trial > 0; --trial) {
    const Atmosphere air = random.chance(0.7) ? varied_earth(random) : random.next();
    const auto tables = std::make_shared<const SkyTables>(precompute_sky(air, small_tables(1)));
    const SkyView view(tables, random.chance(0.7) ? 0.0 : random.number() * (air.top_radius_m - air.bottom_radius_m));
    const SkyQuadrature quadrature = random.chance(0.6) ? SkyQuadrature::gauss_split : SkyQuadrature::gauss;
    for (int suns = 3; suns > 0; --suns) {
      const std::vector<glm::dvec3> sun{random_sun(random)};
      const ErrorBudget budget{random.scale(1e-3, 0.1)};
      const auto choice = choose_sky_harmonics(view, sun, {.bands = 3, .quadrature = quadrature}, budget);
      const SphericalHarmonics truth =
          SkyProjector(view, {.bands = 3, .quadrature = SkyQuadrature::gauss, .zeniths = 128, .azimuths = 256})
              .project(sun[0]);
      for (const auto& entry : choice.tried) {
        const double error = estimates::relative_difference(SkyProjector(view, entry.setting).project(sun[0]), truth);
        all.add(error, entry.estimated_error, text(entry.setting), 1e-5);
        if (choice.met && entry.setting == choice.setting) picked.add(error, budget.relative, text(entry.setting));
      }
    }
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

TEST_CASE("Sizes of a sky's tables are picked by smaller ones", "[estimates][sky]") {
  RandomAtmospheres random(75);
  Honesty all("sky table sizes");
  Honesty picked("sky table sizes, picked");
  SkyTableOptions most = small_tables(1);
  most.sun_zeniths = 32;
  most.transmittance_heights = 32;
  most.transmittance_zeniths = 128;
  most.irradiance_sun_zeniths = 32;
  SkyTableOptions finest = most;
  finest.view_zeniths = 96;
  finest.sun_zeniths = 96;
  finest.sun_angles = 12;
  finest.transmittance_heights = 64;
  finest.transmittance_zeniths = 256;
  for (int trial = trials(3); trial > 0; --trial) {
    const Atmosphere air = varied_earth(random);
    const SkyProbe probe{0.0, {random_sun(random), random_sun(random)}};
    const ErrorBudget budget{random.scale(3e-3, 0.3)};
    const auto choice = choose_sky_tables(air, probe, most, budget);
    const Lights truth = estimates::light_of(precompute_sky(air, finest), probe);
    for (const auto& entry : choice.tried) {
      const double error =
          estimates::worst_difference(estimates::light_of(precompute_sky(air, entry.setting), probe), truth);
      const std::string size = std::to_string(entry.setting.view_zeniths);
      all.add(error, entry.estimated_error, size, 1e-5);
      if (choice.met && entry.setting == choice.setting) picked.add(error, budget.relative, size);
    }
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

TEST_CASE("Orders of scattering are picked by how they fall", "[estimates][sky]") {
  RandomAtmospheres random(76);
  Honesty all("orders of scattering");
  Honesty picked("orders of scattering, picked");
  for (int trial = trials(2); trial > 0; --trial) {
    const Atmosphere air = varied_earth(random);
    const SkyProbe probe{0.0, {random_sun(random)}};
    const ErrorBudget budget{random.scale(1e-3, 0.1)};
    SkyTableOptions most = tiny_tables();
    most.orders = 10;
    const auto choice = choose_sky_orders(air, probe, most, budget);
    most.orders = 30;
    const Lights truth = estimates::light_of(precompute_sky(air, most), probe);
    for (const auto& entry : choice.tried) {
      if (!std::isfinite(entry.estimated_error)) continue;
      const double error =
          estimates::worst_difference(estimates::light_of(precompute_sky(air, entry.setting), probe), truth);
      const std::string orders = std::to_string(entry.setting.orders);
      all.add(error, entry.estimated_error, orders, 1e-5);
      if (choice.met && entry.setting == choice.setting) picked.add(error, budget.relative, orders);
    }
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

}  // namespace welkin::test
