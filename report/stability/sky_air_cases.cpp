// Extreme air: none and a thousand Earths', lobes of any sharpness, layers from 10 m to 100 km, many orders.
#include <cmath>
#include <limits>

#include "report/stability/cases.h"
#include "report/stability/measures.h"
#include "report/stability/sky_measures.h"
#include "welkin/sky_reference.h"

namespace welkin::report::stability {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Atmosphere with_lobe(double asymmetry) {
  Atmosphere air = earth();
  air.aerosol_phase = AerosolPhase::henyey_greenstein;
  air.aerosol_asymmetry = asymmetry;
  return air;
}

/// About the sun, from its centre to 20 degrees away, and elsewhere.
double lobe_error(double asymmetry) {
  const Atmosphere air = with_lobe(asymmetry);
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(air, single_order())), 0.0, {.ground = false});
  std::vector<glm::dvec3> directions = hard_directions(air, 0.0);
  for (const double off : {0.0, 0.05, 0.3, 1.0, 5.0, 20.0}) directions.push_back(sun_direction(30.0 + off, 0.0));
  return radiance_error(view, directions, 30.0);
}

/// Light without air: none, and the sun as it is in space.
double vacuum_wrong() {
  const auto tables = std::make_shared<const SkyTables>(precompute_sky(dense_earth(0.0), single_order()));
  const SkyView view(tables, 0.0, {.ground = false});
  double wrong = unsound_values(*tables);
  for (const float value : tables->scattering) wrong += wrong_if(value != 0.0F);
  for (const glm::dvec3& direction : hard_directions(earth(), 0.0)) {
    wrong += wrong_if(view.radiance(direction, sun_direction(30.0, 0.0)) != glm::dvec3(0.0));
  }
  return wrong;
}

double vacuum_sun_error() {
  const Atmosphere air = dense_earth(0.0);
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(air, single_order())), 0.0);
  const auto& solar = air.solar_irradiance;
  return relative_error(view.sun(sun_direction(30.0, 0.0)).irradiance, glm::dvec3(solar[0], solar[1], solar[2]));
}

SkyTableOptions many_orders(int orders) {
  SkyTableOptions options;
  options.heights = 4;
  options.view_zeniths = 16;
  options.sun_zeniths = 16;
  options.sun_angles = 2;
  options.orders = orders;
  return options;
}

double unsound_tables(double factor, int orders, double albedo) {
  return unsound_values(precompute_sky(with_ground_albedo(dense_earth(factor), albedo), many_orders(orders)));
}

/// Of the sun's light in space, what falls on the ground at most, sky alone.
double most_on_ground(double factor) {
  const SkyTables tables = precompute_sky(dense_earth(factor), many_orders(16));
  double most = 0.0;
  for (std::size_t k = 0; k < tables.irradiance.size(); ++k) {
    most = worse(most, tables.irradiance[k] / tables.atmosphere.solar_irradiance[k % 3]);
  }
  return most;
}

double refusals() {
  const auto refused = [](auto change) {
    Atmosphere air = earth();
    change(air);
    return wrong_unless_thrown(ErrorCode::invalid_argument, [&] { (void)precompute_sky(air, single_order()); }) +
           wrong_unless_thrown(ErrorCode::invalid_argument, [&] { (void)reference_transmittance(air, 0.0, 1.0); });
  };
  double wrong = 0.0;
  for (const double bad : {kNaN, -1.0, std::numeric_limits<double>::infinity()}) {
    wrong += refused([bad](Atmosphere& air) { air.bottom_radius_m = bad; });
    wrong += refused([bad](Atmosphere& air) { air.top_radius_m = bad; });
    wrong += refused([bad](Atmosphere& air) { air.rayleigh.scattering_per_m[1] = bad; });
    wrong += refused([bad](Atmosphere& air) { air.aerosol.absorption_per_m = {bad, 0.0, 0.0}; });
    wrong += refused([bad](Atmosphere& air) { air.solar_irradiance[0] = bad; });
    wrong += refused([bad](Atmosphere& air) { air.sun_angular_radius_degrees = bad; });
    wrong += refused([bad](Atmosphere& air) { air.wavelengths_nm[2] = bad; });
  }
  wrong += refused([](Atmosphere& air) { air.aerosol_asymmetry = kNaN; });
  wrong += refused([](Atmosphere& air) { air.aerosol_asymmetry = 1.0; });
  wrong += refused([](Atmosphere& air) { air.ground_albedo = {0.1, 1.5, 0.1}; });
  wrong += refused([](Atmosphere& air) { air.rayleigh.density[0].exponential_term = kNaN; });
  return wrong + wrong_unless_thrown(ErrorCode::invalid_argument, [] { (void)exponential_profile(-8000.0); }) +
         wrong_unless_thrown(ErrorCode::invalid_argument, [] { (void)exponential_profile(kNaN); });
}

}  // namespace

void add_sky_air_cases(StabilityCases& cases) {
  const auto add = [&](const std::string& name, const std::string& promise, const std::string& truth, double bound,
                       std::function<double()> measure, StabilityUnit unit = StabilityUnit::relative,
                       const std::string& advice = {}) {
    cases.push_back(
        {"sky-air/" + name, promise, truth, unit, bound, [measure](const Control&) { return measure(); }, advice});
  };
  for (const auto& [text, words, g] : {std::tuple{"0", "0", 0.0},
                                       {"0.9", "0.9", 0.9},
                                       {"0.99", "0.99", 0.99},
                                       {"0.999", "0.999", 0.999},
                                       {"minus-0.999", "-0.999", -0.999}}) {
    add(std::string("lobe-") + text, std::string("radiance about the sun and elsewhere, g = ") + words + ", rms",
        "reference_sky_radiance", 5e-3, [g = g] { return lobe_error(g); });
  }
  add("density-0", "without matter the sky is black and nothing is unsound", "closed form: 0", 0.0, vacuum_wrong,
      StabilityUnit::count);
  add("density-0-sun", "without matter the sun is as in space", "closed form", 1e-6, vacuum_sun_error);
  const std::string opaque =
      "Through a thousand Earths' air 1e-28 of the sun's light comes scattered once; the tables have 0. The sky is "
      "what is scattered many times there: bake 16 orders or more (`until_change` says when to stop).";
  for (const auto& [text, factor] : {std::pair{"1e-6", 1e-6}, {"10", 10.0}, {"100", 100.0}, {"1000", 1000.0}}) {
    add(
        std::string("density-") + text,
        std::string("singly scattered radiance of the Earth's air times ") + text + ", rms", "reference_sky_radiance",
        5e-2, [f = factor] { return sky_error(dense_earth(f), 0.0, 30.0); }, StabilityUnit::relative,
        factor > 500.0 ? opaque : "");
  }
  for (const double factor : {1.0, 1000.0}) {
    const std::string text = factor > 1.0 ? "1000" : "1";
    add(
        "orders-64-density-" + text, "64 orders over white ground, air times " + text + ": nothing unsound",
        "not negative, finite", 0.0, [factor] { return unsound_tables(factor, 64, 1.0); }, StabilityUnit::count);
    add("ground-light-density-" + text,
        "16 orders, air times " + text + ": the sky's light on the ground over the sun's",
        "energy: no more than comes (1.1 with tables)", 1.1, [factor] { return most_on_ground(factor); });
  }
  const std::string sparse =
      "All of the air lies in the lowest thousandth of the tables, whose nodes are spread from the ground to the top. "
      "Let the top of such an atmosphere be 50 scale heights above the ground (the case below), not 60 km.";
  const std::string shadow =
      "The planet's shadow is 15 km tall there, 155 scale heights: 1e-25 of the sun's light comes scattered once, and "
      "the tables have 1e-23. Neither is light: fade such a sky out when the sun has set.";
  for (const auto& [text, height] :
       {std::pair{"10m", 10.0}, {"100m", 100.0}, {"1km", 1e3}, {"8km", 8e3}, {"100km", 1e5}}) {
    add(
        std::string("scale-height-") + text,
        std::string("radiance on the ground under 60 km of air of scale height ") + text + ", rms",
        "reference_sky_radiance", 1e-2, [h = height] { return sky_error(plain_planet(6.36e6, 6e4, h), 0.0, 30.0); },
        StabilityUnit::relative, height < 50.0 ? sparse : "");
    add(
        std::string("scale-height-") + text + "-twilight", std::string("the same with the sun at -4 degrees"),
        "reference_sky_radiance", 1e-1, [h = height] { return sky_error(plain_planet(6.36e6, 6e4, h), 0.0, -4.0); },
        StabilityUnit::relative, height == 100.0 ? shadow : "");
  }
  add("scale-height-10m-low-top", "radiance on the ground under 500 m of air of scale height 10 m, rms",
      "reference_sky_radiance", 1e-2, [] { return sky_error(plain_planet(6.36e6, 500.0, 10.0), 0.0, 30.0); });
  add("refusals", "NaN, infinite and negative parameters are refused by tables and reference", "the error's code", 0.0,
      refusals, StabilityUnit::count);
}

}  // namespace welkin::report::stability
