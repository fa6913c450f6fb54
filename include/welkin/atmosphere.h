// An atmosphere as data: what a planet's air scatters and absorbs, and the light that falls on it.
//
// Lengths are metres, coefficients 1/m, wavelengths nanometres, irradiances W/m2/nm. y is up; a sun's azimuth is
// counted from +z towards +x, its elevation from the horizon up.
#pragma once

#include <string>
#include <vector>

#include "welkin/core.h"

namespace WELKIN_EXPORT welkin {

/// A layer of a density profile, relative to the density at which coefficients are stated:
///   density(h) = clamp(exponential_term exp(exponential_scale_per_m h) + linear_term_per_m h + constant_term, 0, 1),
/// h the altitude above the ground (Bruneton 2017, "Precomputed Atmospheric Scattering: a New Implementation",
/// DensityProfileLayer).
struct DensityLayer {
  double thickness_m = 0.0;              ///< the last layer's is not read: it goes up to the top
  double exponential_term = 0.0;         ///< factor of the exponential
  double exponential_scale_per_m = 0.0;  ///< its exponent, 1/m; negative where density falls with altitude
  double linear_term_per_m = 0.0;        ///< slope of the linear part, 1/m
  double constant_term = 0.0;            ///< density at altitude 0 without the exponential

  friend bool operator==(const DensityLayer&, const DensityLayer&) = default;
};

/// exp(-h / scale_height), all the way up. Throws `Error` (invalid_argument) unless it is above 0 and finite.
[[nodiscard]] std::vector<DensityLayer> exponential_profile(double scale_height_m);
/// A tent: 0 at centre -+ half_width, 1 at the centre, linear between: ozone. Throws likewise; the centre may be 0.
[[nodiscard]] std::vector<DensityLayer> tent_profile(double centre_m, double half_width_m);

/// One kind of matter in the air.
struct Constituent {
  std::vector<DensityLayer> density;     ///< from the ground up; none: there is nothing of it
  std::vector<double> scattering_per_m;  ///< at each wavelength, where the density is 1; none: 0
  std::vector<double> absorption_per_m;  ///< likewise

  friend bool operator==(const Constituent&, const Constituent&) = default;
};

/// How an aerosol scatters, by the cosine of the angle that light turns by; a phase function's integral over the sphere
/// is 1.
enum class AerosolPhase {
  cornette_shanks,    ///< Cornette and Shanks 1992: Henyey-Greenstein times (1 + cos^2), as Bruneton has it
  henyey_greenstein,  ///< Henyey and Greenstein 1941
};

/// Luminance of the zenith in a dark place without a moon, cd/m2: 21.8 magnitudes per square arcsecond.
inline constexpr double kDarkNightZenithLuminance = 2e-4;

/// A planet's air, its ground and its sun. The model of all of Welkin's skies, the tables as well as the truth that
/// they are tested against:
/// - Light propagates along straight lines in spherical shells. Sunlight at a point x is solar irradiance times
///   transmittance from x towards the sun's centre, or towards the horizon if the centre is below it, times the visible
///   share of the disc, v(t) = t^2 (3 - 2 t) with t = clamp((e + a) / 2a, 0, 1), e = (mu_s - mu_h) r / R the elevation
///   of the centre over x's own horizon in radians, nearly (mu_s: cosine between zenith and sun; mu_h = -sqrt(1 -
///   (R/r)^2); R: the ground's radius, r: x's), a the sun's angular radius in radians. Of a point (a = 0) 1 above the
///   horizon, else 0. (Bruneton 2017, GetTransmittanceToSun.)
/// - For scattering the sun's direction is that of the centre.
/// - The ground is Lambertian.
struct Atmosphere {
  std::string name;  ///< for people

  /// All rising or all falling, 1 to 1e6. Three for a table of their own radiances (red, green, blue); any number from
  /// 3 to 96 if they are folded to colours.
  std::vector<double> wavelengths_nm{680.0, 550.0, 440.0};

  double bottom_radius_m = 6'360'000.0;  ///< the ground's radius; the air begins there
  double top_radius_m = 6'420'000.0;     ///< above it there is nothing

  Constituent rayleigh;                                        ///< scatters by 3 / (16 pi) (1 + cos^2)
  Constituent aerosol;                                         ///< Mie
  AerosolPhase aerosol_phase = AerosolPhase::cornette_shanks;  ///< how aerosol scatters by angle
  double aerosol_asymmetry = 0.8;                              ///< g, -0.8 to 0.999
  /// g at each wavelength in place of the one above, likewise; none: that one at all. Dust whose lobe is narrower in
  /// blue gives Mars its blue aureole. Where spectra are folded to colours each channel has one lobe, of its
  /// wavelengths' mean g.
  std::vector<double> aerosol_asymmetries;
  std::vector<Constituent> absorbers;  ///< ozone and the like: their scattering must be none; at most 4

  std::vector<double> ground_albedo;           ///< at each wavelength, 0 to 1; none: black
  std::vector<double> solar_irradiance;        ///< above the atmosphere, on a surface facing the sun, W/m2/nm
  double sun_angular_radius_degrees = 0.2678;  ///< 0 (a point) to 10

  /// Light of a night without a moon (airglow, zodiacal light, faint stars), which is there by day too: luminance of
  /// the zenith as seen from the ground, in cd/m2, 0 (none) to 1. Views from within the air add it, their irradiance,
  /// harmonics and curves included; tables and truth do not have it. docs/maths/sky.md has its colour and its shape.
  double night_zenith_luminance = 0.0;

  friend bool operator==(const Atmosphere&, const Atmosphere&) = default;
};

/// Throws `Error` (invalid_argument) that names the parameter, what was found and what would do, unless the atmosphere
/// can be computed: everything finite, as many values as wavelengths, coefficients from 0 to 1e6, irradiances from 0 to
/// 1e12, bottom_radius_m from 1 to 1e9, top_radius_m above it and at most 11 times it, g from -0.8 to 0.999, at most 8
/// layers of thickness 0 to 1e12 and terms up to 1e15, at most 4 absorbers.
void check(const Atmosphere& atmosphere);

/// What floats in the Earth's air.
enum class AerosolKind {
  clear,     ///< the air of a clear day: optical depth 0.1
  hazy,      ///< the same aerosol, 0.32
  dusty,     ///< desert dust, 0.5
  polluted,  ///< continental air near cities, 0.327; absorbs more
};

/// "clear", "hazy", "dusty", "polluted".
[[nodiscard]] const char* name(AerosolKind kind) noexcept;

/// An aerosol by what sun photometers measure. Its extinction follows Angstrom's law, (wavelength / 550 nm)^-exponent;
/// its lobe is Henyey and Greenstein's. The defaults are clear continental air.
struct AerosolModel {
  double optical_depth = 0.1;              ///< vertical, at 550 nm, of extinction; 0 to 100
  double angstrom_exponent = 1.3;          ///< -4 to 8; 0: grey. Small particles have 1 to 2, dust about 0.2
  double single_scattering_albedo = 0.95;  ///< the share of extinction that scatters, 0 to 1
  double asymmetry = 0.7;                  ///< mean cosine of the angle that light turns by, -0.8 to 0.999
  double scale_height_m = 1200.0;          ///< 1 to 1e6

  friend bool operator==(const AerosolModel&, const AerosolModel&) = default;
};

/// The numbers behind a kind of aerosol, with their sources in planets.cpp. Throws `Error` (invalid_argument) for an
/// unknown kind.
[[nodiscard]] AerosolModel aerosol_model(AerosolKind kind);

/// The same atmosphere with that aerosol in place of its own. Throws `Error` (invalid_argument) for values out of
/// range.
[[nodiscard]] Atmosphere with_aerosol(Atmosphere atmosphere, const AerosolModel& aerosol);

/// Earth on a day with that aerosol, at given wavelengths (360 to 830 nm). Rayleigh optical depth 0.0973 at 550 nm
/// (Hansen and Travis 1974), 300 Dobson units of ozone, solar spectrum ASTM G-173, ground albedo 0.1. The illuminance
/// of clear air is within 10 % of the clear sky of IES RP-21-84 for suns of 60, 30 and 10 degrees (docs/maths/sky.md).
/// Throws `Error` (invalid_argument) for other wavelengths and unknown kinds.
[[nodiscard]] Atmosphere earth(const std::vector<double>& wavelengths_nm = {680.0, 550.0, 440.0},
                               AerosolKind aerosol = AerosolKind::clear);
/// Bruneton 2017's Earth at given wavelengths (360 to 830 nm), equal to his program's: Rayleigh 1.24062e-6 (1 um /
/// wavelength)^4, aerosols of scale height 1200 m and optical depth 0.0053 (far less than clear air has), ozone tent at
/// 25 km. Throws `Error` (invalid_argument) for other wavelengths.
[[nodiscard]] Atmosphere earth_bruneton(const std::vector<double>& wavelengths_nm = {680.0, 550.0, 440.0});
/// Hillaire 2020's Earth ("A Scalable and Production Ready Sky and Atmosphere Rendering Technique", table 1).
[[nodiscard]] Atmosphere earth_hillaire();
/// Mars: thin carbon dioxide and dust that absorbs blue, of optical depth 0.5.
[[nodiscard]] Atmosphere mars();
/// The same without aerosol.
[[nodiscard]] Atmosphere without_aerosol(Atmosphere atmosphere);
/// The same with that grey ground albedo, 0 to 1.
[[nodiscard]] Atmosphere with_ground_albedo(Atmosphere atmosphere, double albedo);

/// What the three channels of a computed sky are.
enum class SkyColour {
  spectral,     ///< W/m2/sr/nm at three wavelengths, in the order of `wavelengths_nm`
  linear_srgb,  ///< cd/m2 in linear sRGB: the spectrum folded with the CIE 1931 colour matching functions, 683 lm/W
};

/// Linear sRGB luminance (cd/m2) of radiances (W/m2/sr/nm) at an atmosphere's wavelengths: weights[i] times radiance i,
/// summed. The spectrum between them is linear, outside of them constant. Throws `Error` (invalid_argument).
[[nodiscard]] std::vector<dvec3> srgb_weights(const std::vector<double>& wavelengths_nm);

/// Unit direction towards a sun, elevation from -90 to 90. y up; azimuth from +z towards +x, -1e6 to 1e6. Throws
/// `Error` (invalid_argument).
[[nodiscard]] dvec3 sun_direction(double elevation_degrees, double azimuth_degrees);

}  // namespace welkin
