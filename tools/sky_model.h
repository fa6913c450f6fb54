// Computed skies: from options about air and sun to a sky that can be evaluated, and its report.
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

/// Earth's air as measured, with or without an aerosol, and atmospheres with their own constants.
enum class Air { earth, earth_without_aerosol, earth_bruneton, earth_hillaire, mars };

struct AtmospherePreset {
  Air air = Air::earth;
  AerosolKind aerosol = AerosolKind::clear;  ///< of `Air::earth`
};

/// The air: a preset, or a file; and changes to it.
struct AtmosphereChoice {
  AtmospherePreset preset;
  std::optional<std::string> file;
  std::vector<double> wavelengths_nm;   ///< none: the preset's; for colours, Earth's are a spectrum
  std::optional<double> aerosol_depth;  ///< vertical, at 550 nm
  std::optional<double> ground_albedo;
  std::optional<double> night_luminance;  ///< of the zenith, cd/m2
};

/// Adds --preset, --atmosphere, --wavelengths, --aerosol, --ground-albedo, --night.
void add_atmosphere_options(Options& table, AtmosphereChoice& choice);

/// Returns the chosen atmosphere; members missing in a file are those of a default `Atmosphere`. Throws `Error`:
/// file_access, limit_exceeded (more than a megabyte), corrupt_file for text that is no JSON, for a member of another
/// name or kind than those that `atmosphere_json` writes and for an atmosphere that cannot be computed;
/// invalid_argument for wavelengths or an aerosol depth of an atmosphere with fixed ones.
[[nodiscard]] Atmosphere chosen_atmosphere(const AtmosphereChoice& choice, SkyColour colour);

/// Returns "spectral" or "srgb".
[[nodiscard]] const char* name(SkyColour colour) noexcept;

/// Returns every member, with every digit: --atmosphere reads it back unchanged.
[[nodiscard]] Json atmosphere_json(Atmosphere atmosphere);

/// A sun by date and location.
struct DatedSun {
  std::string date;
  SunObserver observer;
  SunPosition position{};  ///< of the sun at that date and location
};

/// The parameters of a computed sky, for reports.
struct SkyReport {
  Atmosphere atmosphere;
  double sun_elevation_degrees = 0.0;
  double sun_azimuth_degrees = 0.0;  ///< in Welkin's axes
  std::optional<DatedSun> dated;     ///< none: the sun was set by angles
  double altitude_m = 0.0;
  bool ground = true;
  SkyTableOptions tables;
  std::uint64_t table_bytes = 0;
  int orders = 0;
  double last_change = 0.0;
  glm::dvec3 sky_irradiance{};                    ///< on horizontal ground facing up, without the direct sun
  std::optional<SkyHarmonicsOptions> quadrature;  ///< of the harmonics; none: they come from an image
  int directions = 0;                             ///< number of directions of the quadrature
};

/// Returns "W/m2/sr/nm at 680, 550, 440 nm" or "cd/m2, linear sRGB".
[[nodiscard]] std::string sky_unit(const SkyReport& report);

[[nodiscard]] Json sky_json(const SkyReport& report);
/// Returns lines for a person.
[[nodiscard]] std::string sky_lines(const SkyReport& report);

/// An environment that is computed instead of read.
struct ComputedImage {
  LatLongImage image;
  Source source;
  SkyReport sky;
  std::optional<Sun> sun;  ///< not in the image; in Welkin's axes
};

using ComputeImage = std::function<ComputedImage(const Control&)>;

struct SkyParameters {
  AtmosphereChoice atmosphere;
  double sun_elevation_degrees = 40.0;
  double sun_azimuth_degrees = 0.0;
  std::optional<DatedSun> dated;  ///< sets the two angles above
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

/// Makes a sky. Throws the errors of choosing the atmosphere, of making, loading and saving tables, and of `SkyView`.
[[nodiscard]] Sky make_sky(const SkyParameters& parameters, const Control& control);

/// Returns a lat-long twice as wide as `height`, with its sun or without.
[[nodiscard]] ComputedImage sky_image(const Sky& sky, int height, bool sun_disc, const Control& control);

/// Returns the environment of a command without a file: Earth's sky in W/m2/sr/nm at 680, 550, 440 nm, the sun in it 40
/// degrees up, 25 from +z towards +x. In these units all except the sun's disc is below 1 and the disc below 65504, the
/// largest half float: in cd/m2 a bundle's half floats would clip the sun and the .env's RGBD the sky itself.
[[nodiscard]] ComputedImage built_in_sky(const Control& control);

}  // namespace welkin::tool
