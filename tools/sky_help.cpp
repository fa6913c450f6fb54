// The prose of `welkin sky --help`.
#include "tools/help_text.h"

namespace welkin::tool {

constexpr std::string_view kSkyFooter =
    R"(What it does:
  Computes a clear sky from the physics of a planet's air: sunlight scattered by
  its gases (Rayleigh) and aerosol (Mie), absorbed by ozone, reflected by the
  ground, scattered again, as often as --orders says. Tables of it are made, or
  taken from a file; then, for a sun and a height, it prints the sky's spherical
  harmonics as 'welkin sh' does for a photograph, the sun apart as a directional
  light; or bakes them to a folder as 'welkin bake' does; or draws a day.

Examples:
  welkin sky --sun-elevation 20              a table for a person
  welkin sky --sun-elevation 20 --json       for a program, every digit
  welkin sky --sun-elevation 5 --sun-azimuth 90 --for unity --format c
  welkin sky --sun-elevation -4 --altitude 10000
  welkin sky --sun-elevation 20 --orders 1 --ground-albedo 0
                                             singly scattered light alone
  welkin sky --sun-elevation 20 --tables earth.sky
                                             make the tables once, then load them
  welkin sky --sun-elevation 20 -o out       cubemaps, .env, harmonics, sky.exr
  welkin sky --sun-elevation 20 -o out --sun-disc --size 128
  welkin sky --sweep day.png                 noon to night, and day.txt
  welkin sky --preset mars --sweep mars.png --sun-elevation 60
  welkin sky --print-atmosphere > air.json   Earth's air as data, to be changed
  welkin sky --atmosphere air.json --sun-elevation 20
  welkin sky --wavelengths 615,535,445 --sun-elevation 20

Directions: y is up; at azimuth 0 the sun stands towards +z, at 90 towards +x.
  Below the horizon one sees the ground, lit by sun and sky.

Units: radiance W/(m2 sr nm) at the wavelengths that stand for r, g and b;
  irradiance W/(m2 nm). With --colour srgb luminance, cd/m2, in linear sRGB, and
  illuminance, lux. Lengths are metres.

JSON: as 'welkin sh --json' prints it, the sun always apart in "sun" {direction,
  irradiance, radiance, solid_angle, angular_radius_degrees, flux_after (of the
  sky), flux_before (with the sun)}, and "sky" {atmosphere, unit, colour,
  sun_elevation_degrees, sun_azimuth_degrees, altitude_m, orders, last_change,
  ground, sky_irradiance, quadrature, tables, parameters}. error_estimate is that
  of the quadrature alone; docs/sky.md has the tables' errors.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

}  // namespace welkin::tool
