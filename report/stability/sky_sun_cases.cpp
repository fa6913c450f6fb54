// The sun from the zenith to 18 degrees below the horizon, and beyond.
#include <cmath>

#include "report/stability/cases.h"
#include "report/stability/measures.h"
#include "report/stability/sky_measures.h"
#include "welkin/sky_harmonics.h"

namespace welkin::report::stability {
namespace {

double sky_radiance_error(double elevation) {
  static const SkyView view(earth_tables(), 0.0, {.ground = false});
  return radiance_error(view, hard_directions(earth(), 0.0), elevation);
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
  static const SkyView view(std::make_shared<const SkyTables>(precompute_sky(earth())), 0.0);
  const glm::dvec3 sun = sun_direction(elevation, 40.0);
  return relative_error(SkyCurve(view).at(sun), SkyProjector(view, SkyCurveOptions{}.projection).project(sun));
}

/// Two suns next to each other have the same sky.
double step(const glm::dvec3& one, const glm::dvec3& other) {
  return relative_error(projector(16).project(one), projector(16).project(other));
}

/// Below the tables' lowest sun and at the nadir.
double unsound_nights() {
  double wrong = 0.0;
  for (const double elevation : {-18.0, -29.9, -30.0, -30.1, -45.0, -89.999, -90.0}) {
    const glm::dvec3 sun = sun_direction(elevation, 10.0);
    for (const glm::dvec3& direction : hard_directions(earth(), 0.0)) {
      const glm::dvec3 light = ground_view().radiance(direction, sun);
      for (int c = 0; c < 3; ++c) wrong += wrong_if(!(light[c] >= 0.0) || std::isinf(light[c]));
    }
    wrong += wrong_if(!std::isfinite(norm(projector(16).project(sun))));
    wrong += wrong_if(norm(constant_radiance(ground_view().sun(sun).irradiance)) != 0.0);
  }
  return wrong;
}

struct Elevation {
  const char* text;  ///< in names
  double degrees;
  double radiance;   ///< bound of radiance, most of it next to the horizon: percents at the planet's shadow's edges
  double harmonics;  ///< of the projector, by sky_harmonics.h
  double curve;      ///< of the curve, likewise
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
    const std::string words = e.text;
    const std::string degrees = words.starts_with("minus") ? words.substr(5) : words;
    const std::string name_end = "-at-" + words;
    const std::string promise_end = ", sun at " + degrees + " degrees";
    const auto add = [&](const char* what, const std::string& promise, const char* truth, double bound,
                         double (*measure)(double)) {
      cases.push_back({std::string("sky-sun/").append(what).append(name_end), promise + promise_end, truth,
                       StabilityUnit::relative, bound,
                       [measure, elevation = e.degrees](const Control&) { return measure(elevation); },
                       std::string(what) != "radiance" && e.degrees < -15.0 ? night : ""});
    };
    add("radiance", "singly scattered radiance of the Earth, rms", "reference_sky_radiance", e.radiance,
        sky_radiance_error);
    add("harmonics", "nine coefficients at the default setting", "128 x 128 nodes of the same view", e.harmonics,
        harmonics_error);
    add("curve", "nine coefficients of the curve", "the projection it is made of", e.curve, curve_error);
  }
  cases.push_back({"sky-sun/curve-at-minus-18-default",
                   "nine coefficients of the curve at -18 degrees, tables of the default sizes and orders",
                   "the projection it is made of", StabilityUnit::relative, 1e-1,
                   [](const Control&) { return default_curve_error(-18.0); }});
  const auto add_step = [&](const char* name, const char* promise, const glm::dvec3& one, const glm::dvec3& other) {
    cases.push_back({name, promise, "the neighbouring sun", StabilityUnit::relative, 1e-6,
                     [=](const Control&) { return step(one, other); }});
  };
  add_step("sky-sun/step-zenith", "suns 1e-9 degrees from the zenith, on opposite sides",
           sun_direction(90.0 - 1e-9, 0.0), sun_direction(90.0 - 1e-9, 180.0));
  add_step("sky-sun/step-horizon", "suns 1e-9 degrees above and below the horizon", sun_direction(1e-9, 30.0),
           sun_direction(-1e-9, 30.0));
  add_step("sky-sun/step-lowest", "suns 1e-9 degrees above and below the tables' lowest",
           sun_direction(-30.0 + 1e-9, 30.0), sun_direction(-30.0 - 1e-9, 30.0));
  cases.push_back({"sky-sun/nights",
                   "from -18 degrees to the nadir nothing is negative or not finite, and no sun shines",
                   "what night is", StabilityUnit::count, 0.0, [](const Control&) { return unsound_nights(); }});
}

}  // namespace welkin::report::stability
