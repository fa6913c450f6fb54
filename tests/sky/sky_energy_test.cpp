// Skies neither make light nor lose it.
#include "math/quadrature.h"
#include "reference/sky_reference.h"
#include "sky/sky_geometry.h"
#include "sky/sunlight.h"
#include "sky/table_mapping.h"
#include "support/catch.h"
#include "support/random_atmospheres.h"
#include "support/small_skies.h"
#include "support/trials.h"
#include "welkin/sky.h"

namespace welkin::test {

// Promise: light is neither made nor lost: no air is black, twice the sun is twice the light, and what does not absorb
// sends back all that came in.

namespace {

using std::numbers::pi;

SkyTableOptions small_options(int orders) {
  return {.heights = 8,
          .view_zeniths = 16,
          .sun_zeniths = 16,
          .sun_angles = 4,
          .transmittance_heights = 8,
          .transmittance_zeniths = 32,
          .irradiance_heights = 4,
          .irradiance_sun_zeniths = 16,
          .orders = orders};
}

/// Without absorption, over a ground that reflects all.
Atmosphere conservative(double depth, double asymmetry) {
  Atmosphere air;
  air.rayleigh.density = exponential_profile(8000.0);
  air.rayleigh.scattering_per_m.assign(3, 0.5 * depth / 8000.0);
  air.aerosol.density = exponential_profile(4000.0);
  air.aerosol.scattering_per_m.assign(3, 0.5 * depth / 4000.0);
  air.aerosol_asymmetry = asymmetry;
  air.solar_irradiance = {1.0, 1.0, 1.0};
  return with_ground_albedo(air, 1.0);
}

/// W/m2 that go up through the top: from the planet's disc, and from the air around it.
double flux_up(const SkyView& top, const glm::dvec3& sun) {
  constexpr int azimuths = 24;
  const math::GaussRule rule = math::gauss_legendre(16);
  const double rim = -sky::horizon_cosine(top.tables()->atmosphere.bottom_radius_m, top.altitude_m());
  double flux = 0.0;
  for (const auto& [low, high] : {std::pair{0.0, rim}, {rim, 1.0}}) {
    for (int i = 0; i < rule.order; ++i) {
      const double cosine = low + (high - low) * (0.5 + 0.5 * rule.nodes[i]);
      const double sine = std::sqrt(1.0 - cosine * cosine);
      for (int k = 0; k < azimuths; ++k) {
        const double azimuth = 2.0 * pi * (k + 0.5) / azimuths;
        const glm::dvec3 down(sine * std::sin(azimuth), -cosine, sine * std::cos(azimuth));
        flux += 0.5 * (high - low) * rule.weights[i] * cosine * 2.0 * pi / azimuths * top.radiance(down, sun)[1];
      }
    }
  }
  return flux;
}

/// Towards a sun by the cosine of its zenith angle.
glm::dvec3 sun_at(double cosine) { return {0.0, cosine, std::sqrt(std::max(0.0, 1.0 - cosine * cosine))}; }

}  // namespace

TEST_CASE("More orders never take light away, and each adds less", "[sky][tables]") {
  double before = 1e300;
  std::vector<float> last;
  for (int orders = 1; orders <= 5; ++orders) {
    SkyTableOptions options = small_options(orders);
    options.truncate_orders = true;
    const SkyTables tables = precompute_sky(earth_bruneton(), options);
    CHECK(tables.orders == orders);
    if (orders > 1) {
      CHECK(tables.last_change < before);
      CHECK(tables.last_change > 0.0);
      // By night what lies between two suns follows how steeply light falls, which more orders change.
      const float night = 1e-5F * *std::max_element(last.begin(), last.end());
      for (std::size_t i = 0; i < last.size(); ++i) REQUIRE(tables.irradiance[i] >= last[i] - night);
    }
    before = tables.last_change;
    last = tables.irradiance;
  }
}

// All light that falls on the top, pi r^2, leaves it again: scattered and reflected, over the whole planet, or
// unscattered past the ground. Orders that add less than 1e-4 are estimated.
TEST_CASE("Air and ground that absorb nothing send back all sunlight to 1 %", "[sky][tables][truth]") {
  for (const double depth : {0.1, 0.5}) {
    const Atmosphere air = conservative(depth, 0.6);
    const auto tables = sky_tables_of(air, {.heights = 16, .orders = 64, .convergence_threshold = 1e-4});
    const SkyView top(tables, air.top_radius_m - air.bottom_radius_m);
    const sky::TableMapping mapping = sky::mapping_of(*tables);
    double scattered = 0.0;  // over the sun's zenith cosine: a quarter of the sphere's area times four
    const int last = tables->options.sun_zeniths - 1;
    for (int sun = 0; sun < last; ++sun) {
      const double low = mapping.sun_zenith_cosine(static_cast<double>(sun) / last);
      const double high = mapping.sun_zenith_cosine((sun + 1.0) / last);
      scattered += 0.5 * (flux_up(top, sun_at(low)) + flux_up(top, sun_at(high))) * (high - low);
    }
    // 2 pi r^2 scattered + straight = pi r^2
    double straight = 0.0;
    const double r = air.top_radius_m;
    constexpr int steps = 200;
    for (int k = 0; k < steps; ++k) {
      const double h = 6e4 * (k + 0.5) / steps;  // nearest to the ground
      const double through = reference_transmittance(air, h, 0.0)[0];
      straight += 2.0 * (air.bottom_radius_m + h) * 6e4 / steps * through * through / (r * r);
    }
    CAPTURE(depth, tables->orders, scattered, straight);
    CHECK(std::abs(2.0 * scattered + straight - 1.0) < 0.01);
  }
}

// The lobe is narrower than the spacing of the directions over which orders are summed. Light that an aerosol deflects
// by a degree or two reaches the ground as if there were none, as light that goes straight on is not scattered at all.
TEST_CASE("An aerosol that scatters straight on takes nothing away", "[sky][tables][truth]") {
  SkyTableOptions options = small_options(32);
  options.convergence_threshold = 1e-4;
  const auto irradiance = [&](const Atmosphere& air) {
    const SkyTables tables = precompute_sky(air, options);
    const sky::TableMapping mapping = sky::mapping_of(tables);
    std::vector<double> all;
    for (int sun = 0; sun < options.irradiance_sun_zeniths; ++sun) {
      const double mu = mapping.sun_zenith_cosine(sun / (options.irradiance_sun_zeniths - 1.0));
      if (mu < 0.1) continue;
      all.push_back(static_cast<double>(tables.irradiance[3 * static_cast<std::size_t>(sun)]) +
                    mu * reference_sun_irradiance(air, 0.0, sun_at(mu))[0]);
    }
    return all;
  };
  Atmosphere clear = with_ground_albedo(conservative(0.5, 0.0), 0.0);
  Atmosphere hazy = clear;
  clear.aerosol = {};
  const std::vector<double> without = irradiance(clear);
  for (const double asymmetry : {0.95, 0.99, 0.999}) {
    hazy.aerosol_asymmetry = asymmetry;
    const std::vector<double> with = irradiance(hazy);
    REQUIRE(with.size() == without.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
      CAPTURE(asymmetry, i, with[i] / without[i]);
      CHECK(with[i] < 1.01 * without[i]);
      CHECK(with[i] > (asymmetry > 0.98 ? 0.97 : 0.9) * without[i]);
    }
  }
}

// Promise: a shell of air that is thin against its planet does not make light, whatever the sun's elevation.

namespace {

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

}  // namespace

// All light that an aerosol of any lobe scatters in a slab over black ground leaves at the top or arrives below.
TEST_CASE("A slab that absorbs nothing keeps its light for lobes of any sharpness",
          "[sky][tables][view][haze][truth]") {
  SkyTableOptions options{.heights = 16, .orders = 24, .convergence_threshold = 1e-4};
  for (const double asymmetry : some_of(2, {-0.8, 0.5, 0.95, 0.8, 0.999})) {
    Atmosphere air = with_ground_albedo(shell(6.36e6, 0.5), 0.0);
    std::swap(air.rayleigh, air.aerosol);
    air.aerosol_phase = AerosolPhase::henyey_greenstein;
    air.aerosol_asymmetry = asymmetry;
    const auto tables = sky_tables_of(air, options);
    const SkyView top(tables, 1000.0);
    const SkyView bottom(tables, 0.0);
    for (const double elevation : {90.0, 45.0}) {
      const glm::dvec3 sun = sun_direction(elevation, 0.0);
      const double down = bottom.irradiance(sun)[1] + sun.y * bottom.sun_light(sun).irradiance[1];
      const double kept = (flux_up(top, sun) + down) / sun.y;
      CAPTURE(asymmetry, elevation, kept);
      CHECK(kept > 0.997);
      CHECK(kept < 1.002);
    }
  }
}

TEST_CASE("What is estimated of further orders is neither more nor less than there is", "[sky][tables][view][truth]") {
  for (const double asymmetry : {0.0, 0.7}) {
    Atmosphere air = with_ground_albedo(shell(6.36e6, 0.5), 0.5);
    if (asymmetry > 0.0) std::swap(air.rayleigh, air.aerosol);
    air.aerosol_phase = AerosolPhase::henyey_greenstein;
    air.aerosol_asymmetry = asymmetry;
    const auto tables_of = [&](int orders, bool exact) {
      // Orders that add less than 1e-6 are left out.
      return sky_tables_of(air,
                           {.heights = 16, .orders = orders, .convergence_threshold = 1e-6, .truncate_orders = exact});
    };
    const auto light = [](const std::shared_ptr<const SkyTables>& tables, const glm::dvec3& sun) {
      return glm::dvec2(flux_up(SkyView(tables, 1000.0), sun), SkyView(tables, 0.0).irradiance(sun)[1]);
    };
    const auto all = tables_of(32, true);
    for (const int orders : {2, 4}) {
      const auto estimated = tables_of(orders, false);
      const auto exact = tables_of(orders, true);
      for (const double elevation : {90.0, 20.0}) {
        const glm::dvec3 sun = sun_direction(elevation, 0.0);
        const glm::dvec2 found = light(estimated, sun) / light(all, sun);
        CAPTURE(asymmetry, elevation, orders, found.x, found.y);
        CHECK(std::abs(found.x - 1.0) < (orders > 2 ? 1e-3 : 3e-2));
        CHECK(std::abs(found.y - 1.0) < (orders > 2 ? 1e-3 : 3e-2));
        CHECK(light(exact, sun).x < 0.99 * light(all, sun).x);
      }
    }
  }
}

// Promise: no atmosphere that is accepted gives tables with a negative value or one that is no number, nor more light
// on the ground than the sun sends.

namespace {

bool sound(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return value >= 0.0F && std::isfinite(value); });
}

/// Bound of the irradiance on the ground, relative to the solar irradiance.
constexpr double kMaxOnGround = 1.1;
constexpr SkyTableOptions kUsable{.heights = 16, .view_zeniths = 32, .sun_zeniths = 32, .sun_angles = 4};

double most_on_ground(const SkyTables& tables) {
  double most = 0.0;
  for (std::size_t k = 0; k < tables.irradiance.size(); ++k) {
    most = std::max(most, static_cast<double>(tables.irradiance[k]) / tables.atmosphere.solar_irradiance[k % 3]);
  }
  return most;
}

}  // namespace

// Heights of sun paths lay three scale heights apart: 1.4 times the sun's light arrived.
// Four kilometres of haze under 47 640 km of nothing: the lowest two of five heights lay a thousand scale heights
// apart, so each order came to the ground nearly as strong as the one before, and 1.3 times the sun's light arrived.
TEST_CASE("Orders of light in low haze under a thick shell fade", "[sky][tables][truth]") {
  Atmosphere air;
  air.bottom_radius_m = 45.44e6;
  air.top_radius_m = air.bottom_radius_m + 47.64e6;
  air.aerosol.density = exponential_profile(4067.0);
  air.aerosol.scattering_per_m = {0.0526, 0.0242, 0.0202};
  air.aerosol_asymmetry = 0.999;
  air.solar_irradiance = {1.0, 1.0, 1.0};
  SkyTableOptions options{.heights = 5,
                          .view_zeniths = 4,
                          .sun_zeniths = 5,
                          .sun_angles = 3,
                          .irradiance_heights = 3,
                          .irradiance_sun_zeniths = 5,
                          .truncate_orders = true};
  std::vector<double> sums;
  for (options.orders = 3; options.orders <= 6; ++options.orders) {
    sums.push_back(most_on_ground(precompute_sky(with_ground_albedo(air, 0.0), options)));
  }
  CAPTURE(sums);
  CHECK(sums.back() < 1.0);
  CHECK(sums[3] - sums[2] < 0.7 * (sums[1] - sums[0]));
}

TEST_CASE("Tables of random atmospheres are finite, not negative and hold no more light than comes",
          "[sky][random][truth]") {
  RandomAtmospheres atmospheres(2026);
  for (int i = 0; i < trials(20); ++i) {
    const int wavelengths = i % 5 == 4 ? 7 : 3;
    const Atmosphere air = atmospheres.next(wavelengths);
    const SkyTableOptions options{
        .layout = i % 3 == 0 ? ScatteringLayout::compact : ScatteringLayout::full,
        .heights = atmospheres.whole(2, 5),
        .view_zeniths = 2 * atmospheres.whole(2, 5),
        .sun_zeniths = atmospheres.whole(4, 8),
        .sun_angles = atmospheres.whole(2, 4),
        .transmittance_heights = atmospheres.whole(2, 8),
        .transmittance_zeniths = atmospheres.whole(2, 16),
        .irradiance_heights = atmospheres.whole(2, 4),
        .irradiance_sun_zeniths = atmospheres.whole(2, 9),
        .minimum_sun_elevation_degrees = atmospheres.between(-90.0, 0.0),
        .orders = atmospheres.whole(1, 4),
        .colour = wavelengths > 3 ? SkyColour::linear_srgb : SkyColour::spectral,
    };
    const SkyTables tables = precompute_sky(air, options);
    CAPTURE(i, air.bottom_radius_m, air.top_radius_m, air.aerosol_asymmetry, options.orders);
    REQUIRE(sound(tables.transmittance));
    REQUIRE(sound(tables.scattering));
    REQUIRE(sound(tables.single_mie));
    REQUIRE(sound(tables.irradiance));
    CHECK(*std::max_element(tables.transmittance.begin(), tables.transmittance.end()) <= 1.0F);
    if (wavelengths > 3) continue;
    REQUIRE(most_on_ground(tables) <= kMaxOnGround);
    if (i % 20 == 0) REQUIRE(most_on_ground(precompute_sky(air, kUsable)) <= kMaxOnGround);
  }
}

}  // namespace welkin::test
