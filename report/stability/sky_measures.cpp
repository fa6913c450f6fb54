#include "report/stability/sky_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "report/stability/measures.h"
#include "welkin/sky_reference.h"

namespace welkin::report::stability {
namespace {

constexpr std::array<double, 3> kAzimuths{0.1, 1.4, 3.0};  ///< radians from the sun's

void multiply(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

void add_rings(std::vector<glm::dvec3>& directions, double zenith_angle) {
  for (const double azimuth : kAzimuths) {
    const double ring = std::sin(zenith_angle);
    directions.emplace_back(ring * std::sin(azimuth), std::cos(zenith_angle), ring * std::cos(azimuth));
  }
}

}  // namespace

Atmosphere dense_earth(double factor) {
  Atmosphere air = earth();
  for (Constituent* const matter : {&air.rayleigh, &air.aerosol}) {
    multiply(matter->scattering_per_m, factor);
    multiply(matter->absorption_per_m, factor);
  }
  for (Constituent& matter : air.absorbers) multiply(matter.absorption_per_m, factor);
  return air;
}

Atmosphere plain_planet(double radius_m, double thickness_m, double scale_height_m) {
  Atmosphere air;
  air.name = "plain";
  air.bottom_radius_m = radius_m;
  air.top_radius_m = radius_m + thickness_m;
  air.rayleigh.density = exponential_profile(scale_height_m);
  const double per_metre = 0.1 / std::min(scale_height_m, thickness_m);
  air.rayleigh.scattering_per_m = {0.5 * per_metre, per_metre, 2.0 * per_metre};
  air.solar_irradiance = {1.5, 1.8, 1.9};
  return air;
}

SkyTableOptions single_order() {
  SkyTableOptions options;
  options.heights = 8;
  options.orders = 1;
  return options;
}

const std::shared_ptr<const SkyTables>& earth_tables() {
  static const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth(), single_order()));
  return tables;
}

std::vector<glm::dvec3> hard_directions(const Atmosphere& atmosphere, double altitude_m) {
  const double bottom = atmosphere.bottom_radius_m;
  const double thickness = atmosphere.top_radius_m - bottom;
  const double radius = bottom + altitude_m;
  std::vector<glm::dvec3> directions;
  if (altitude_m > thickness) {
    for (const double share : {-0.9, -0.1, 0.1, 0.5, 0.9}) {  // of the way from the limb's ground to the top, or nadir
      const double passes = bottom + share * (share < 0.0 ? bottom : thickness);
      add_rings(directions, std::numbers::pi - std::asin(passes / radius));
    }
    return directions;
  }
  const double horizon = std::numbers::pi - std::asin(std::min(1.0, bottom / radius));
  for (const double angle : {0.0, 0.5, 1.0, 1.3, 1.5}) add_rings(directions, angle);
  for (const double off : {-1e-2, -1e-4, -1e-6, 1e-6, 1e-4, 1e-2}) add_rings(directions, horizon + off);
  for (const double angle : {2.0, 2.6}) add_rings(directions, angle);
  return directions;
}

double radiance_error(const SkyView& view, const std::vector<glm::dvec3>& directions, double sun_elevation_degrees) {
  const glm::dvec3 sun = sun_direction(sun_elevation_degrees, 0.0);
  std::vector<glm::dvec3> found;
  std::vector<glm::dvec3> truth;
  for (const glm::dvec3& direction : directions) {
    const std::vector<double> reference = reference_sky_radiance(
        view.tables()->atmosphere, view.altitude_m(), direction, sun, {.relative_error = 1e-5, .ground = false});
    truth.emplace_back(reference[0], reference[1], reference[2]);
    found.push_back(view.radiance(direction, sun));
  }
  return rms_error(found, truth);
}

double sky_error(const Atmosphere& atmosphere, double altitude_m, double sun_elevation_degrees,
                 const SkyTableOptions& options) {
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(atmosphere, options)), altitude_m,
                     {.ground = false});
  return radiance_error(view, hard_directions(atmosphere, altitude_m), sun_elevation_degrees);
}

double unsound_values(const SkyTables& tables) {
  return unsound(tables.transmittance) + unsound(tables.scattering) + unsound(tables.single_mie) +
         unsound(tables.irradiance);
}

}  // namespace welkin::report::stability
