// Grazing rays at the scale of planets: transmittance in closed form, the horizon from both sides.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "report/stability/cases.h"
#include "report/stability/measures.h"
#include "report/stability/sky_measures.h"
#include "welkin/sky_reference.h"

namespace welkin::report::stability {
namespace {

constexpr double kPi = std::numbers::pi;

/// e^x K1(x) for x above 30: Hankel's asymptotic series (DLMF 10.40.2).
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

/// Exponential air that is 40 scale heights thick, of which a horizontal ray from the ground meets the optical depth 1.
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

/// The sun through the tables' air against the reference.
double sun_error(double elevation, double altitude) {
  const SkyView view(earth_tables(), altitude);
  const glm::dvec3 sun = sun_direction(elevation, 0.0);
  const std::vector<double> truth = reference_sun_irradiance(earth(), altitude, sun);
  return relative_error(view.sun(sun).irradiance, glm::dvec3(truth[0], truth[1], truth[2]));
}

/// Tables of as many heights as the default.
const std::shared_ptr<const SkyTables>& usual_tables() {
  static const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth(), {.orders = 1}));
  return tables;
}

/// Radiance just above and below a horizon.
double horizon_error(const std::shared_ptr<const SkyTables>& tables, double altitude) {
  const SkyView view(tables, altitude, {.ground = false});
  const double horizon = kPi - std::asin(6.36e6 / (6.36e6 + altitude));
  std::vector<glm::dvec3> directions;
  for (const double off : {-1e-3, -1e-5, -1e-7, 1e-7, 1e-5, 1e-3}) {
    directions.emplace_back(0.0, std::cos(horizon + off), std::sin(horizon + off));
  }
  return radiance_error(view, directions, 30.0);
}

/// The lanes' floats against the call for one direction in double: what rounding a direction to float costs.
double lanes_error(double altitude) {
  const SkyView view(earth_tables(), altitude);
  const glm::dvec3 sun = sun_direction(30.0, 0.0);
  const std::vector<glm::dvec3> directions = hard_directions(earth(), altitude);
  std::vector<glm::vec3> in_float(directions.begin(), directions.end());
  std::vector<glm::vec3> rgb(directions.size());
  view.radiance(in_float, sun, rgb);
  std::vector<glm::dvec3> one_by_one;
  one_by_one.reserve(in_float.size());
  for (const glm::vec3& direction : in_float) one_by_one.push_back(view.radiance(glm::dvec3(direction), sun));
  return rms_error(std::vector<glm::dvec3>(rgb.begin(), rgb.end()), one_by_one);
}

}  // namespace

void add_sky_ray_cases(StabilityCases& cases) {
  const auto add = [&](const std::string& name, const std::string& promise, const std::string& truth, double bound,
                       std::function<double()> measure) {
    cases.push_back({"sky-rays/" + name, promise, truth, StabilityUnit::relative, bound,
                     [measure](const Control&) { return measure(); }});
  };
  for (const auto& [text, radius, height] : {std::tuple{"earth-10m", 6.36e6, 10.0},
                                             {"earth-1km", 6.36e6, 1e3},
                                             {"earth-8km", 6.36e6, 8e3},
                                             {"earth-100km", 6.36e6, 1e5},
                                             {"giant-1km", 1e9, 1e3},
                                             {"one-metre", 1.0, 0.01}}) {
    add(std::string("grazing-depth-") + text, "optical depth of a horizontal ray from the ground",
        "closed form: beta R e^x K1(x), x = R / H", 1e-9,
        [=, r = radius, h = height] { return grazing_depth_error(r, h); });
    add(std::string("vertical-depth-") + text, "optical depth of a vertical ray",
        "closed form: beta H (1 - e^(-T / H))", 1e-9,
        [=, r = radius, h = height] { return vertical_depth_error(r, h); });
  }
  for (const auto& [text, cosine] : {std::pair{"1e-12", 1e-12}, {"1e-8", 1e-8}}) {
    add(std::string("grazing-step-") + text,
        std::string("a ray with zenith cosine ") + text + " meets what the horizontal one does", "the horizontal ray",
        1e-6, [c = cosine] { return depth_step_at_horizon(c); });
  }
  for (const auto& [text, words, elevation, altitude] : {std::tuple{"90", "90 degrees", 90.0, 0.0},
                                                         {"1", "1 degree", 1.0, 0.0},
                                                         {"0.3", "0.3 degrees", 0.3, 0.0},
                                                         {"0", "0 degrees", 0.0, 0.0},
                                                         {"minus-0.1", "-0.1 degrees", -0.1, 0.0},
                                                         {"minus-3-at-10km", "-3 degrees, from 10 km", -3.0, 1e4}}) {
    add(std::string("sun-at-") + text, std::string("direct sun through the tables' air at ") + words,
        "reference_sun_irradiance", 1e-3, [e = elevation, a = altitude] { return sun_error(e, a); });
  }
  cases.push_back({"sky-rays/horizon-from-2m-few-heights",
                   "radiance from 1e-7 to 1e-3 radians above and below the horizon, seen from 2 m, by tables of 8 "
                   "heights instead of 32, rms",
                   "reference_sky_radiance", StabilityUnit::relative, 1e-2,
                   [](const Control&) { return horizon_error(earth_tables(), 2.0); },
                   "Below the horizon from some metres up a ray is kilometres of air, which few heights do not tell "
                   "from none: in the worst direction half of its light is wrong with 8, a twentieth with 32, a "
                   "thousandth with 128. Take at least the default's heights; 128 where the haze between viewer and "
                   "ground is looked at."});
  for (const auto& [text, altitude] : {std::pair{"0", 0.0}, {"2m", 2.0}, {"10km", 1e4}, {"59km", 5.9e4}}) {
    add(std::string("horizon-from-") + text,
        std::string("radiance from 1e-7 to 1e-3 radians above and below the horizon, seen from ") + text +
            ", default sizes, rms",
        "reference_sky_radiance", 1e-2, [a = altitude] { return horizon_error(usual_tables(), a); });
    add(std::string("lanes-from-") + text,
        "many directions at once give what one after another do, from " + std::string(text),
        "SkyView::radiance, one direction", 1e-6, [a = altitude] { return lanes_error(a); });
  }
}

}  // namespace welkin::report::stability
