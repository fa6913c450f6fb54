// Skies: rays that graze a planet, suns anywhere, air of any density, planets of any size.
#include "reference/sky_reference.h"
#include "stability/cases.h"
#include "stability/measures.h"
#include "standard_headers.h"
#include "support/small_skies.h"
#include "welkin/sky.h"

namespace welkin::test::stability {

// Grazing rays at the scale of planets: transmittance in closed form, the horizon from both sides.
namespace {

constexpr double kPi = std::numbers::pi;

/// Returns e^x K1(x) for x above 30, by Hankel's asymptotic series (DLMF 10.40.2).
double scaled_bessel_k1(double x) {
  double term = 1.0;
  double sum = 1.0;
  for (int k = 1; k < 30; ++k) {
    term *= (4.0 - (2.0 * k - 1.0) * (2.0 * k - 1.0)) / (k * 8.0 * x);
    sum += term;
    if (std::abs(term) < 1e-18) break;
  }
  return std::sqrt(kPi / (2.0 * x)) * sum;
}

/// Returns exponential air, 40 scale heights thick, in which a horizontal ray from the ground has optical depth 1.
Atmosphere grazed_planet(double radius, double scale_height) {
  Atmosphere air = plain_planet(radius, 40.0 * scale_height, scale_height);
  const double per_metre = 1.0 / (radius * scaled_bessel_k1(radius / scale_height));
  air.rayleigh.scattering_per_m = {per_metre, per_metre, per_metre};
  return air;
}

/// A horizontal ray from the ground through exponential air: beta R e^(R/H) K1(R/H).
double grazing_depth_error(double radius, double scale_height) {
  const double through = reference_transmittance(grazed_planet(radius, scale_height), 0.0, 0.0)[0];
  return relative_error(-std::log(through), 1.0);
}

double vertical_depth_error(double radius, double scale_height) {
  const Atmosphere air = plain_planet(radius, 0.01 * radius, scale_height);
  const double depth = air.rayleigh.scattering_per_m[1] * scale_height * -std::expm1(-0.01 * radius / scale_height);
  return relative_error(-std::log(reference_transmittance(air, 0.0, 1.0)[1]), depth);
}

/// A ray that leaves the ground at a tiny angle differs from the horizontal one by no more than that angle allows.
double depth_step_at_horizon(double cosine) {
  const Atmosphere air = grazed_planet(6.36e6, 8000.0);
  const double level = -std::log(reference_transmittance(air, 0.0, 0.0)[0]);
  return relative_error(-std::log(reference_transmittance(air, 0.0, cosine)[0]), level);
}

/// Compares the sun through the tables' air with the reference.
double sun_error(double elevation, double altitude) {
  const SkyView view(earth_tables(), altitude);
  const glm::dvec3 sun = sun_direction(elevation, 0.0);
  const std::vector<double> truth = reference_sun_irradiance(earth_bruneton(), altitude, sun);
  return relative_error(view.sun_light(sun).irradiance, glm::dvec3(truth[0], truth[1], truth[2]));
}

/// Returns tables with the default number of heights.
const std::shared_ptr<const SkyTables>& usual_tables() {
  static const auto tables = sky_tables_of(earth_bruneton(), {.orders = 1});
  return tables;
}

/// Compares radiance just above and below a horizon.
double horizon_error(const std::shared_ptr<const SkyTables>& tables, double altitude) {
  const SkyView view(tables, altitude, {.ground = false});
  const double horizon = kPi - std::asin(6.36e6 / (6.36e6 + altitude));
  std::vector<glm::dvec3> directions;
  for (const double off : {-1e-3, -1e-5, -1e-7, 1e-7, 1e-5, 1e-3}) {
    directions.emplace_back(0.0, std::cos(horizon + off), std::sin(horizon + off));
  }
  return radiance_error(view, directions, 30.0);
}

}  // namespace

void add_sky_ray_cases(StabilityCases& cases) {
  struct Air {
    std::string text;
    double radius, height;
  };
  for (const Air& air : {Air{"earth-10m", 6.36e6, 10.0},
                         {"earth-1km", 6.36e6, 1e3},
                         {"earth-8km", 6.36e6, 8e3},
                         {"earth-100km", 6.36e6, 1e5},
                         {"giant-1km", 1e9, 1e3},
                         {"one-metre", 1.0, 0.01}}) {
    cases.add("grazing-depth-" + air.text, "optical depth of a horizontal ray from the ground",
              "closed form: beta R e^x K1(x), x = R / H", {1e-9},
              [=] { return grazing_depth_error(air.radius, air.height); });
    cases.add("vertical-depth-" + air.text, "optical depth of a vertical ray", "closed form: beta H (1 - e^(-T / H))",
              {1e-9}, [=] { return vertical_depth_error(air.radius, air.height); });
  }
  for (const std::string cosine : {"1e-12", "1e-8"}) {
    cases.add("grazing-step-" + cosine, "a ray with zenith cosine " + cosine + " meets what the horizontal one does",
              "the horizontal ray", {1e-6}, [c = std::stod(cosine)] { return depth_step_at_horizon(c); });
  }
  struct SunPlace {
    std::string text, words;
    double elevation, altitude;
  };
  for (const SunPlace& sun : {SunPlace{"90", "90 degrees", 90.0, 0.0},
                              {"1", "1 degree", 1.0, 0.0},
                              {"0.3", "0.3 degrees", 0.3, 0.0},
                              {"0", "0 degrees", 0.0, 0.0},
                              {"minus-0.1", "-0.1 degrees", -0.1, 0.0},
                              {"minus-3-at-10km", "-3 degrees, from 10 km", -3.0, 1e4}}) {
    cases.add("sun-at-" + sun.text, "direct sun through the tables' air at " + sun.words, "reference_sun_irradiance",
              {1e-3}, [=] { return sun_error(sun.elevation, sun.altitude); });
  }
  const std::string few =
      "Below the horizon from some metres up a ray is kilometres of air, which few heights do not tell from none: in "
      "the worst direction half of its light is wrong with 8, a twentieth with 32, a thousandth with 128. Take at "
      "least "
      "the default's heights; 128 where the haze between viewer and ground is looked at.";
  cases.add("horizon-from-2m-few-heights",
            "radiance from 1e-7 to 1e-3 radians above and below the horizon, seen from 2 m, by tables of 8 heights "
            "instead of 32, rms",
            "reference_sky_radiance", {.bound = 1e-2, .advice = few},
            [] { return horizon_error(earth_tables(), 2.0); });
  for (const Named& altitude : {Named{"0", 0.0}, {"2m", 2.0}, {"10km", 1e4}, {"59km", 5.9e4}}) {
    cases.add("horizon-from-" + altitude.text,
              "radiance from 1e-7 to 1e-3 radians above and below the horizon, seen from " + altitude.text +
                  ", default sizes, rms",
              "reference_sky_radiance", {1e-2}, [=] { return horizon_error(usual_tables(), altitude.value); });
  }
}

// The sun from the zenith to 18 degrees below the horizon, and beyond.
namespace {

double sky_radiance_error(double elevation) {
  static const SkyView view(earth_tables(), 0.0, {.ground = false});
  return radiance_error(view, hard_directions(earth_bruneton(), 0.0), elevation);
}

const SkyView& ground_view() {
  static const SkyView view(earth_tables(), 0.0);
  return view;
}

const SkyProjector& projector(int nodes) {
  static const SkyProjector usual(ground_view());
  static const SkyProjector curve(ground_view(), SkyCurveOptions{}.projection);
  static const SkyProjector fine(
      ground_view(), {.bands = 3, .quadrature = SkyQuadrature::gauss_split, .zeniths = 128, .azimuths = 128});
  return nodes == 16 ? usual : nodes == 32 ? curve : fine;
}

double harmonics_error(double elevation) {
  const glm::dvec3 sun = sun_direction(elevation, 40.0);
  return relative_error(projector(16).project(sun), projector(128).project(sun));
}

double curve_error(double elevation) {
  static const SkyCurve curve(ground_view());
  const glm::dvec3 sun = sun_direction(elevation, 40.0);
  return relative_error(curve.at(sun), projector(32).project(sun));
}

/// By tables of the default sizes and orders.
double default_curve_error(double elevation) {
  static const SkyView view = sky_view_of(earth_bruneton());
  const glm::dvec3 sun = sun_direction(elevation, 40.0);
  return relative_error(SkyCurve(view).at(sun), SkyProjector(view, SkyCurveOptions{}.projection).project(sun));
}

/// Two suns next to each other have the same sky.
double step(const glm::dvec3& one, const glm::dvec3& other) {
  return relative_error(projector(16).project(one), projector(16).project(other));
}

struct Elevation {
  std::string text;  ///< in names
  double degrees;
  double radiance;   ///< bound of radiance, most of it next to the horizon: percents at the planet's shadow's edges
  double harmonics;  ///< bound of the projector, by sky.h
  double curve;      ///< bound of the curve, by sky.h
};

}  // namespace

void add_sky_sun_cases(StabilityCases& cases) {
  const std::string night =
      "At -18 degrees no singly scattered light reaches the ground: what these tables (one order, 8 heights) and the "
      "curve have is their interpolation between suns. Tables of the default sizes and orders hold what is promised "
      "(curve-at-minus-18-default); with single scattering alone fade the sky to the stars' light below -12 degrees.";
  for (const Elevation& e : {Elevation{"90", 90.0, 1e-3, 2.5e-4, 4e-4},
                             {"45", 45.0, 1e-3, 2.5e-4, 4e-4},
                             {"2", 2.0, 1e-3, 2.5e-4, 4e-4},
                             {"0.27", 0.27, 5e-3, 2.5e-4, 4e-4},
                             {"0", 0.0, 2e-2, 2.5e-4, 4e-4},
                             {"minus-0.27", -0.27, 2e-2, 2.5e-4, 4e-4},
                             {"minus-4", -4.0, 5e-3, 2.5e-4, 4e-4},
                             {"minus-6", -6.0, 5e-3, 2.5e-4, 4e-4},
                             {"minus-9", -9.0, 5e-2, 3e-3, 6e-3},
                             {"minus-12", -12.0, 5e-2, 1e-1, 2e-2},
                             {"minus-18", -18.0, 5e-2, 1e-1, 1e-1}}) {
    const std::string promise_end =
        ", sun at " + (e.text.starts_with("minus") ? e.text.substr(5) : e.text) + " degrees";
    const std::string advice = e.degrees < -15.0 ? night : "";
    cases.add("radiance-at-" + e.text, "singly scattered radiance of the Earth, rms" + promise_end,
              "reference_sky_radiance", {e.radiance}, [=] { return sky_radiance_error(e.degrees); });
    cases.add("harmonics-at-" + e.text, "nine coefficients at the default setting" + promise_end,
              "128 x 128 nodes of the same view", {.bound = e.harmonics, .advice = advice},
              [=] { return harmonics_error(e.degrees); });
    cases.add("curve-at-" + e.text, "nine coefficients of the curve" + promise_end, "the projection it is made of",
              {.bound = e.curve, .advice = advice}, [=] { return curve_error(e.degrees); });
  }
  cases.add("curve-at-minus-18-default",
            "nine coefficients of the curve at -18 degrees, tables of the default sizes and orders",
            "the projection it is made of", {1e-1}, [] { return default_curve_error(-18.0); });
  const auto add_step = [&](const char* name, const char* promise, const glm::dvec3& one, const glm::dvec3& other) {
    cases.add(name, promise, "the neighbouring sun", {1e-6}, [=] { return step(one, other); });
  };
  add_step("step-zenith", "suns 1e-9 degrees from the zenith, on opposite sides", sun_direction(90.0 - 1e-9, 0.0),
           sun_direction(90.0 - 1e-9, 180.0));
  add_step("step-horizon", "suns 1e-9 degrees above and below the horizon", sun_direction(1e-9, 30.0),
           sun_direction(-1e-9, 30.0));
  add_step("step-lowest", "suns 1e-9 degrees above and below the tables' lowest", sun_direction(-30.0 + 1e-9, 30.0),
           sun_direction(-30.0 - 1e-9, 30.0));
}

// Extreme air: none and a thousand Earths', lobes of any sharpness, layers from 10 m to 100 km, many orders.
namespace {

Atmosphere with_lobe(double asymmetry) {
  Atmosphere air = earth_bruneton();
  air.aerosol_phase = AerosolPhase::henyey_greenstein;
  air.aerosol_asymmetry = asymmetry;
  return air;
}

/// About the sun, from its centre to 20 degrees away, and elsewhere.
double lobe_error(double asymmetry) {
  const Atmosphere air = with_lobe(asymmetry);
  const SkyView view(sky_tables_of(air, single_order()), 0.0, {.ground = false});
  std::vector<glm::dvec3> directions = hard_directions(air, 0.0);
  for (const double off : {0.0, 0.05, 0.3, 1.0, 5.0, 20.0}) directions.push_back(sun_direction(30.0 + off, 0.0));
  return radiance_error(view, directions, 30.0);
}

/// Without air there must be no scattered light, and the sun's irradiance in space.
double vacuum_wrong() {
  const auto tables = sky_tables_of(dense_earth(0.0), single_order());
  const SkyView view(tables, 0.0, {.ground = false});
  double wrong = unsound_values(*tables);
  for (const float value : tables->scattering) wrong += wrong_if(value != 0.0F);
  for (const glm::dvec3& direction : hard_directions(earth_bruneton(), 0.0)) {
    wrong += wrong_if(view.radiance(direction, sun_direction(30.0, 0.0)) != glm::dvec3(0.0));
  }
  return wrong;
}

double vacuum_sun_error() {
  const Atmosphere air = dense_earth(0.0);
  const SkyView view = sky_view_of(air, single_order());
  const auto& solar = air.solar_irradiance;
  return relative_error(view.sun_light(sun_direction(30.0, 0.0)).irradiance, glm::dvec3(solar[0], solar[1], solar[2]));
}

SkyTableOptions many_orders(int orders) {
  SkyTableOptions options{.heights = 4, .view_zeniths = 16, .sun_zeniths = 16, .sun_angles = 2, .orders = orders};
  return options;
}

double unsound_tables(double factor, int orders, double albedo) {
  return unsound_values(precompute_sky(with_ground_albedo(dense_earth(factor), albedo), many_orders(orders)));
}

/// Returns the maximum irradiance of the sky on the ground, relative to the sun's in space.
double most_on_ground(double factor) {
  const SkyTables tables = precompute_sky(dense_earth(factor), many_orders(16));
  double most = 0.0;
  for (std::size_t k = 0; k < tables.irradiance.size(); ++k) {
    most = worse(most, tables.irradiance[k] / tables.atmosphere.solar_irradiance[k % 3]);
  }
  return most;
}

}  // namespace

void add_sky_air_cases(StabilityCases& cases) {
  for (const std::string asymmetry : {"0", "0.9", "0.99", "0.999", "-0.8"}) {
    cases.add("lobe-" + (asymmetry[0] == '-' ? "minus" + asymmetry : asymmetry),
              "radiance about the sun and elsewhere, g = " + asymmetry + ", rms", "reference_sky_radiance", {5e-3},
              [g = std::stod(asymmetry)] { return lobe_error(g); });
  }
  cases.add_count("density-0", "without matter the sky is black and nothing is unsound", "closed form: 0",
                  vacuum_wrong);
  cases.add("density-0-sun", "without matter the sun is as in space", "closed form", {1e-6}, vacuum_sun_error);
  const std::string opaque =
      "Through a thousand Earths' air 1e-28 of the sun's light comes scattered once; the tables have 0. The sky is "
      "what is scattered many times there: bake 16 orders or more (`convergence_threshold` says when to stop).";
  for (const std::string text : {"1e-6", "10", "100", "1000"}) {
    cases.add("density-" + text, "singly scattered radiance of the Earth's air times " + text + ", rms",
              "reference_sky_radiance", {.bound = 5e-2, .advice = text == "1000" ? opaque : ""},
              [factor = std::stod(text)] { return sky_error(dense_earth(factor), 0.0, 30.0); });
  }
  for (const std::string text : {"1", "1000"}) {
    const double factor = std::stod(text);
    cases.add_count("orders-64-density-" + text, "64 orders over white ground, air times " + text + ": nothing unsound",
                    "not negative, finite", [factor] { return unsound_tables(factor, 64, 1.0); });
    cases.add("ground-light-density-" + text,
              "16 orders, air times " + text + ": the sky's light on the ground over the sun's",
              "energy: no more than comes (1.1 with tables)", {1.1}, [factor] { return most_on_ground(factor); });
  }
  const std::string sparse =
      "All of the air lies in the lowest thousandth of the tables, whose nodes are spread from the ground to the top. "
      "Let the top of such an atmosphere be 50 scale heights above the ground (the case below), not 60 km.";
  const std::string shadow =
      "The planet's shadow is 15 km tall there, 155 scale heights: 1e-25 of the sun's light comes scattered once, and "
      "the tables have 1e-23. Neither is light: fade such a sky out when the sun has set.";
  for (const Named& height : {Named{"10m", 10.0}, {"100m", 100.0}, {"1km", 1e3}, {"8km", 8e3}, {"100km", 1e5}}) {
    const auto error = [metres = height.value](double sun) {
      return sky_error(plain_planet(6.36e6, 6e4, metres), 0.0, sun);
    };
    cases.add("scale-height-" + height.text,
              "radiance on the ground under 60 km of air of scale height " + height.text + ", rms",
              "reference_sky_radiance", {.bound = 1e-2, .advice = height.value < 50.0 ? sparse : ""},
              [=] { return error(30.0); });
    cases.add("scale-height-" + height.text + "-twilight", "the same with the sun at -4 degrees",
              "reference_sky_radiance", {.bound = 1e-1, .advice = height.value == 100.0 ? shadow : ""},
              [=] { return error(-4.0); });
  }
  cases.add("scale-height-10m-low-top", "radiance on the ground under 500 m of air of scale height 10 m, rms",
            "reference_sky_radiance", {1e-2}, [] { return sky_error(plain_planet(6.36e6, 500.0, 10.0), 0.0, 30.0); });
}

// Planets of any size, seen from the ground, the top and ten radii away.
namespace {

double planet_error(double radius, double thickness, double altitude, const SkyTableOptions& options = single_order()) {
  return sky_error(plain_planet(radius, thickness, thickness / 8.0), altitude, 30.0, options);
}

double earth_error(double altitude) {
  const SkyView view(earth_tables(), altitude, {.ground = false});
  return radiance_error(view, hard_directions(earth_bruneton(), altitude), 30.0);
}

/// A planet's sky is the same at any scale: lengths times 1e6, coefficients over it.
double scaled_difference() {
  const auto harmonics = [](double scale) {
    const SkyView view = sky_view_of(plain_planet(scale, 0.01 * scale, 0.00125 * scale), single_order());
    return SkyProjector(view).project(sun_direction(20.0, 0.0));
  };
  return relative_error(harmonics(0x1p26), harmonics(0x1p4));
}

}  // namespace

void add_sky_planet_cases(StabilityCases& cases) {
  for (const Named& radius : {Named{"1m", 1.0}, {"1km", 1e3}, {"100km", 1e5}, {"1e9m", 1e9}}) {
    const double r = radius.value;
    cases.add("radius-" + radius.text, "radiance on a planet of radius " + radius.text + ", air of 1 % of it, rms",
              "reference_sky_radiance", {1e-2}, [r] { return planet_error(r, 0.01 * r, 0.0); });
    cases.add("radius-" + radius.text + "-from-space", "the same from ten radii away, or 1e9 m",
              "reference_sky_radiance", {1e-2}, [r] { return planet_error(r, 0.01 * r, std::min(1e9, 10.0 * r)); });
  }
  cases.add("thick-air", "radiance on a planet of 1 km under 9 km of air, rms", "reference_sky_radiance", {1e-2},
            [] { return planet_error(1e3, 9e3, 0.0); });
  const std::string flat =
      "The longest ray through such a shell is 1400 times the shortest (the Earth's: 15 times). View zeniths are "
      "spread "
      "evenly by length, so that nearly all of the sky lies before the first one. Give such tables 1024 of them.";
  cases.add("thin-air", "radiance on a planet of 1e6 m under 1 m of air, rms", "reference_sky_radiance",
            {.bound = 1e-2, .advice = flat}, [] { return planet_error(1e6, 1.0, 0.0); });
  SkyTableOptions fine = single_order();
  fine.view_zeniths = 1024;
  fine.transmittance_zeniths = 1024;
  cases.add("thin-air-1024", "the same with tables of 1024 view zeniths", "reference_sky_radiance", {1e-2},
            [fine] { return planet_error(1e6, 1.0, 0.0, fine); });
  struct Viewer {
    std::string text, words;
    double altitude;
  };
  for (const Viewer& viewer : {Viewer{"0", "the ground", 0.0},
                               {"1mm", "1 mm", 1e-3},
                               {"10km", "10 km", 1e4},
                               {"60km-less-1mm", "1 mm less than 60 km", 59'999.999},
                               {"60km", "60 km", 6e4},
                               {"60km-and-1mm", "60 km and 1 mm", 60'000.001},
                               {"400km", "400 km", 4e5},
                               {"ten-radii", "ten radii", 6.36e7},
                               {"1e9m", "a million km", 1e9}}) {
    cases.add("altitude-" + viewer.text, "the Earth's radiance from " + viewer.words + ", rms",
              "reference_sky_radiance", {2e-2}, [=] { return earth_error(viewer.altitude); });
  }
  cases.add("scale-free", "a planet 4 million times larger with its air is the same sky", "the small planet", {1e-6},
            scaled_difference);
}

}  // namespace welkin::test::stability
