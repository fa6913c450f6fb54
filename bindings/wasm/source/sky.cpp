// Computed skies, and where the sun stands.
#include "welkin/sky.h"

#include <memory>
#include <utility>
#include <vector>

#include "interface.h"
#include "light.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::wasm {
namespace {

enum SkyOption { kSkyElevation, kSkyAzimuth, kSkyAltitude, kSkyAerosol, kSkyTables, kSkySize, kSkyDisc, kSkyLight };

/// The tables of one sky at a time: a turned sun needs no new ones.
std::shared_ptr<const SkyTables> sky_tables(int aerosol, bool full, const Control& control) {
  static auto& kept = *new std::shared_ptr<const SkyTables>;
  static int kept_aerosol = -1;
  static bool kept_full = false;
  if (kept && kept_aerosol == aerosol && kept_full == full) return kept;
  SkyTableOptions tables;
  if (!full) {
    tables.heights = 8;
    tables.view_zeniths = 64;
    tables.sun_zeniths = 32;
    tables.sun_angles = 4;
    tables.orders = 2;
  }
  Atmosphere air = earth({680.0, 550.0, 440.0}, static_cast<AerosolKind>(aerosol));
  kept = std::make_shared<const SkyTables>(precompute_sky(air, tables, control));
  kept_aerosol = aerosol;
  kept_full = full;
  return kept;
}

/// Results: those of `bake_pixels` of the sky without its disc; the sun (direction, irradiance, radius in degrees).
void compute_sky(const Options& options) {
  const auto tables = sky_tables(options.whole(kSkyAerosol), options.whole(kSkyTables) != 0, part(0.0, 0.7));
  const SkyView view(tables, options.number(kSkyAltitude));
  const dvec3 direction = sun_direction(options.number(kSkyElevation), options.number(kSkyAzimuth));
  require_edge("size", options.whole(kSkySize));
  const Cubemap faces = sky_cubemap(view, direction, options.whole(kSkySize), {.sun_disc = options.flag(kSkyDisc)});
  const CubemapView cube = faces.view();
  bake_pixels(nullptr, &cube, options, kSkyLight, {}, 0.7);
  const Sun sun = view.sun_light(direction);
  give(std::vector<double>{sun.direction.x, sun.direction.y, sun.direction.z, sun.irradiance.x, sun.irradiance.y,
                           sun.irradiance.z, sun.angular_radius_degrees});
}

enum CurveOption { kCurveAltitude, kCurveAerosol, kCurveTables, kCurveElevations, kCurveCount };

/// The light of a sky by the sun's elevation, which a page interpolates in each frame. Results: three bands of radiance
/// for each elevation, with the sun's azimuth 0; direct irradiance; the sun's radius in degrees.
void sample_curve(const Options& options) {
  const auto tables = sky_tables(options.whole(kCurveAerosol), options.whole(kCurveTables) != 0, part(0.0, 0.9));
  const SkyView view(tables, options.number(kCurveAltitude));
  const SkyCurve curve(view, {}, part(0.9, 1.0));
  const auto* const elevations = options.pointer<double>(kCurveElevations);
  std::vector<double> light;
  std::vector<double> direct;
  for (int k = 0; k < options.whole(kCurveCount); ++k) {
    const dvec3 sun = sun_direction(elevations[k], 0.0);
    const SphericalHarmonics radiance = curve.at(sun);
    for (const dvec3& coefficient : radiance.coefficients()) {
      light.insert(light.end(), {coefficient.x, coefficient.y, coefficient.z});
    }
    const dvec3 irradiance = curve.sun_irradiance(sun);
    direct.insert(direct.end(), {irradiance.x, irradiance.y, irradiance.z});
  }
  give(std::move(light));
  give(std::move(direct));
  give(std::vector<double>{view.sun_light(sun_direction(90.0, 0.0)).angular_radius_degrees});
}

enum SunOption { kDateText, kSeconds, kLatitude, kLongitude, kNorth, kRefraction, kPressure, kTemperature };

/// The date is text, or seconds from 1970 where there is none. Result: elevation, azimuth, compass, refraction in
/// degrees, distance in astronomical units, direction.
void place_sun(const Options& options) {
  const char* date = options.pointer<char>(kDateText);
  const SunPosition sun = sun_position(date != nullptr ? unix_seconds(date) : options.number(kSeconds),
                                       {.latitude_degrees = options.number(kLatitude),
                                        .longitude_degrees = options.number(kLongitude),
                                        .north_azimuth_degrees = options.number(kNorth),
                                        .refraction = options.flag(kRefraction),
                                        .pressure_hpa = options.number(kPressure),
                                        .temperature_celsius = options.number(kTemperature)});
  give(std::vector<double>{sun.elevation_degrees, sun.azimuth_degrees, sun.compass_degrees, sun.refraction_degrees,
                           sun.distance_au, sun.direction.x, sun.direction.y, sun.direction.z});
}

}  // namespace
}  // namespace welkin::wasm

WELKIN_ENTRY(welkin_sky) int welkin_sky(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::compute_sky, options);
}

WELKIN_ENTRY(welkin_sky_curve) int welkin_sky_curve(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::sample_curve, options);
}

WELKIN_ENTRY(welkin_sun_by_date) int welkin_sun_by_date(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::place_sun, options);
}
