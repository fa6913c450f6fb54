// Planets of any size, seen from the ground, the top and ten radii away.
#include <algorithm>
#include <cmath>

#include "report/stability/cases.h"
#include "report/stability/measures.h"
#include "report/stability/sky_measures.h"
#include "welkin/sky_harmonics.h"

namespace welkin::report::stability {
namespace {

double planet_error(double radius, double thickness, double altitude, const SkyTableOptions& options = single_order()) {
  return sky_error(plain_planet(radius, thickness, thickness / 8.0), altitude, 30.0, options);
}

double earth_error(double altitude) {
  const SkyView view(earth_tables(), altitude, {.ground = false});
  return radiance_error(view, hard_directions(earth(), altitude), 30.0);
}

/// A planet is the same sky at any scale: lengths times 1e6, coefficients over it.
double scaled_difference() {
  const auto harmonics = [](double scale) {
    const auto tables = std::make_shared<const SkyTables>(
        precompute_sky(plain_planet(scale, 0.01 * scale, 0.00125 * scale), single_order()));
    return SkyProjector(SkyView(tables, 0.0)).project(sun_direction(20.0, 0.0));
  };
  return relative_error(harmonics(0x1p26), harmonics(0x1p4));
}

/// Just inside and outside of the top: the same sky.
double step_at_top() {
  const double top = 60'000.0;
  const SkyView below(earth_tables(), top - 1e-3);
  const SkyView above(earth_tables(), top + 1e-3);
  std::vector<glm::dvec3> a;
  std::vector<glm::dvec3> b;
  for (const glm::dvec3& d : hard_directions(earth(), top)) {
    a.push_back(below.radiance(d, sun_direction(30.0, 0.0)));
    b.push_back(above.radiance(d, sun_direction(30.0, 0.0)));
  }
  return rms_error(a, b);
}

}  // namespace

void add_sky_planet_cases(StabilityCases& cases) {
  const auto add = [&](const std::string& name, const std::string& promise, const std::string& truth, double bound,
                       std::function<double()> measure, const std::string& advice = {}) {
    cases.push_back({"sky-planet/" + name, promise, truth, StabilityUnit::relative, bound,
                     [measure](const Control&) { return measure(); }, advice});
  };
  for (const auto& [text, radius] : {std::pair{"1m", 1.0}, {"1km", 1e3}, {"100km", 1e5}, {"1e9m", 1e9}}) {
    add(std::string("radius-") + text,
        std::string("radiance on a planet of radius ") + text + ", air of 1 % of it, rms", "reference_sky_radiance",
        1e-2, [r = radius] { return planet_error(r, 0.01 * r, 0.0); });
    add(std::string("radius-") + text + "-from-space", "the same from ten radii away, or 1e9 m",
        "reference_sky_radiance", 1e-2, [r = radius] { return planet_error(r, 0.01 * r, std::min(1e9, 10.0 * r)); });
  }
  add("thick-air", "radiance on a planet of 1 km under 9 km of air, rms", "reference_sky_radiance", 1e-2,
      [] { return planet_error(1e3, 9e3, 0.0); });
  add(
      "thin-air", "radiance on a planet of 1e6 m under 1 m of air, rms", "reference_sky_radiance", 1e-2,
      [] { return planet_error(1e6, 1.0, 0.0); },
      "The longest ray through such a shell is 1400 times the shortest (the Earth's: 15 times). View zeniths are "
      "spread "
      "evenly by length, so that nearly all of the sky lies before the first one. Give such tables 1024 of them.");
  SkyTableOptions fine = single_order();
  fine.view_zeniths = 1024;
  fine.transmittance_zeniths = 1024;
  add("thin-air-1024", "the same with tables of 1024 view zeniths", "reference_sky_radiance", 1e-2,
      [fine] { return planet_error(1e6, 1.0, 0.0, fine); });
  for (const auto& [text, words, altitude] : {std::tuple{"0", "the ground", 0.0},
                                              {"1mm", "1 mm", 1e-3},
                                              {"10km", "10 km", 1e4},
                                              {"60km-less-1mm", "1 mm less than 60 km", 59'999.999},
                                              {"60km", "60 km", 6e4},
                                              {"60km-and-1mm", "60 km and 1 mm", 60'000.001},
                                              {"400km", "400 km", 4e5},
                                              {"ten-radii", "ten radii", 6.36e7},
                                              {"1e9m", "a million km", 1e9}}) {
    add(std::string("altitude-") + text, std::string("the Earth's radiance from ") + words + ", rms",
        "reference_sky_radiance", 2e-2, [a = altitude] { return earth_error(a); });
  }
  add("step-at-top", "radiance 1 mm below and above the top of the air", "the other side", 1e-3, step_at_top);
  add("scale-free", "a planet 4 million times larger with its air is the same sky", "the small planet", 1e-6,
      scaled_difference);
}

}  // namespace welkin::report::stability
