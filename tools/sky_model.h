// Computed skies: from the command line's words about air and sun to one that can be looked at, and what is said of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/arguments.h"
#include "tools/input.h"
#include "tools/json.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

/// Earth's air as measured, with an aerosol or without, and atmospheres with constants of their own.
enum class Air { earth, earth_without_aerosol, earth_bruneton, earth_hillaire, mars };

struct AtmospherePreset {
  Air air = Air::earth;
  AerosolKind aerosol = AerosolKind::clear;  ///< of `Air::earth`
};

/// Which air: a preset, or a file; and what is changed of it.
struct AtmosphereChoice {
  AtmospherePreset preset;
  std::optional<std::string> file;
  std::vector<double> wavelengths_nm;   ///< none: the preset's; folded to colours, Earth's are a spectrum
  std::optional<double> aerosol_depth;  ///< vertical, at 550 nm
  std::optional<double> ground_albedo;
  std::optional<double> night_luminance;  ///< of the zenith, cd/m2
};

/// --preset, --atmosphere, --wavelengths, --aerosol, --ground-albedo, --night.
void add_atmosphere_options(Options& table, AtmosphereChoice& choice);

/// Of a file, what is missing is as in a default `Atmosphere`. Throws `Error`: file_access, limit_exceeded (more than a
/// megabyte), corrupt_file for what is no JSON, for a member of another name or kind than those that `atmosphere_json`
/// writes and for an atmosphere that cannot be computed; invalid_argument for wavelengths or an aerosol's depth of an
/// atmosphere that has but its own.
[[nodiscard]] Atmosphere chosen_atmosphere(const AtmosphereChoice& choice, SkyColour colour);

/// "spectral", "srgb".
[[nodiscard]] const char* name(SkyColour colour) noexcept;

/// Every member, with every digit: read again by --atmosphere it is the same.
[[nodiscard]] Json atmosphere_json(Atmosphere atmosphere);

/// A sun by date and place.
struct DatedSun {
  std::string date;
  SunObserver observer;
  SunPosition position{};  ///< of them
};

/// What a computed sky was made of, for those who read of it.
struct SkyReport {
  Atmosphere atmosphere;
  double sun_elevation_degrees = 0.0;
  double sun_azimuth_degrees = 0.0;  ///< in Welkin's axes
  std::optional<DatedSun> dated;     ///< none: the sun was placed by angles
  double altitude_m = 0.0;
  bool ground = true;
  SkyTableOptions tables;
  std::uint64_t table_bytes = 0;
  int orders = 0;
  double last_change = 0.0;
  glm::dvec3 sky_irradiance{};                    ///< on horizontal ground facing up, without the direct sun
  std::optional<SkyHarmonicsOptions> quadrature;  ///< of the harmonics; none: they are of an image
  int directions = 0;                             ///< that it looks along
};

/// "W/m2/sr/nm at 680, 550, 440 nm" or "cd/m2, linear sRGB".
[[nodiscard]] std::string sky_unit(const SkyReport& report);

[[nodiscard]] Json sky_json(const SkyReport& report);
/// Some lines for a person.
[[nodiscard]] std::string sky_lines(const SkyReport& report);

/// An environment that is computed and not read.
struct ComputedImage {
  LatLongImage image;
  Source source;
  SkyReport sky;
  std::optional<Sun> sun;  ///< that is not in the image, Welkin's axes
};

using ComputeImage = std::function<ComputedImage(const Control&)>;

struct SkyParameters {
  AtmosphereChoice atmosphere;
  double sun_elevation_degrees = 40.0;
  double sun_azimuth_degrees = 0.0;
  std::optional<DatedSun> dated;  ///< which set these two
  double altitude_m = 0.0;
  SkyViewOptions view;
  SkyTableOptions tables;
  std::optional<std::string> tables_file;
};

struct Sky {
  SkyView view;
  glm::dvec3 sun{};  ///< unit, towards it, in Welkin's axes
  SkyReport report;
  std::vector<PassRecord> passes;
};

/// Throws what choosing the atmosphere, making, loading and saving tables, and `SkyView` throw.
[[nodiscard]] Sky make_sky(const SkyParameters& parameters, const Control& control);

/// A lat-long twice as wide as `height`, with its sun or without.
[[nodiscard]] ComputedImage sky_image(const Sky& sky, int height, bool sun_disc, const Control& control);

/// The environment of a command to which no file is given: Earth's sky in W/m2/sr/nm at 680, 550, 440 nm, the sun in it
/// 40 degrees up, 25 from +z towards +x. In these units all but the sun's disc lies below 1 and the disc below 65504,
/// the largest half: in cd/m2 a bundle's half floats would clip the sun and the .env's RGBD the sky itself.
[[nodiscard]] ComputedImage built_in_sky(const Control& control);

}  // namespace welkin::tool
