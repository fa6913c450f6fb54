// Computed skies: scattering tables of a planet's atmosphere, the sky seen from one altitude, and its harmonics.
//
//   auto tables = std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth()));   // seconds
//   welkin::SkyView view(tables, 0.0);                                     // milliseconds, once per altitude
//   welkin::dvec3 sun = welkin::sun_direction(20.0, 145.0);
//   welkin::Cubemap image = welkin::sky_cubemap(view, sun, 256);
//   welkin::SphericalHarmonics light = welkin::SkyProjector(view).project(sun);
//
// Conventions: y is up. `sun` is a direction towards the sun. A sun's azimuth is measured from +z towards +x, its
// elevation from the horizon upwards. Lengths are in metres, coefficients in 1/m, wavelengths in nanometres, spectral
// irradiances in W/m2/nm. Values out of range throw `Error` (invalid_argument).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- Atmospheres: what a planet's air scatters and absorbs, and the sunlight that reaches it

/// A layer of a density profile, relative to the density at which coefficients are stated:
///   density(h) = clamp(exponential_term exp(exponential_scale_per_m h) + linear_term_per_m h + constant_term, 0, 1),
/// where h is the altitude above the ground (Bruneton 2017, "Precomputed Atmospheric Scattering: a New Implementation",
/// DensityProfileLayer).
struct DensityLayer {
  double thickness_m = 0.0;              ///< ignored for the last layer, which extends to the top
  double exponential_term = 0.0;         ///< factor of the exponential
  double exponential_scale_per_m = 0.0;  ///< exponent, 1/m; negative where density decreases with altitude
  double linear_term_per_m = 0.0;        ///< slope of the linear part, 1/m
  double constant_term = 0.0;            ///< density at altitude 0 without the exponential

  friend bool operator==(const DensityLayer&, const DensityLayer&) = default;
};

/// Returns the profile exp(-h / scale_height) at all altitudes h. Throws `Error` (invalid_argument) unless the scale
/// height is finite and above 0.
[[nodiscard]] std::vector<DensityLayer> exponential_profile(double scale_height_m);
/// Returns a tent profile, as for ozone: 1 at the centre, 0 from half_width below and above it on, linear in between.
/// Throws `Error` (invalid_argument) unless the lengths are finite, the centre at least 0 and the half-width above 0.
[[nodiscard]] std::vector<DensityLayer> tent_profile(double centre_m, double half_width_m);

/// One constituent of the air.
struct Constituent {
  std::vector<DensityLayer> density;     ///< from the ground up; empty if the constituent is absent
  std::vector<double> scattering_per_m;  ///< per wavelength, where the density is 1; empty for 0
  std::vector<double> absorption_per_m;  ///< per wavelength, where the density is 1; empty for 0

  friend bool operator==(const Constituent&, const Constituent&) = default;
};

/// Phase function of an aerosol, by the cosine of the scattering angle. Phase functions are normalized to an integral
/// of 1 over the sphere.
enum class AerosolPhase {
  cornette_shanks,    ///< Cornette and Shanks 1992: Henyey-Greenstein times (1 + cos^2), as used by Bruneton
  henyey_greenstein,  ///< Henyey and Greenstein 1941
};

/// Luminance of the zenith at a dark site without a moon, in cd/m2: 21.8 magnitudes per square arcsecond.
inline constexpr double kDarkNightZenithLuminance = 2e-4;

/// A planet's air, its ground and its sun. All skies use this model, and so does the reference of their tests:
/// - Light propagates along straight lines in spherical shells. Sunlight at a point x is the product of solar
///   irradiance, the transmittance from x to the sun's centre (to the horizon if the centre is below it), and the
///   visible fraction v of the disc (Bruneton 2017, GetTransmittanceToSun). v = t^2 (3 - 2 t) with t = clamp((e + a) /
///   2a, 0, 1), where a is the sun's angular radius and e its centre's approximate elevation over x's horizon, in
///   radians: e = (mu_s - mu_h) r / R. mu_s is the cosine of the sun's zenith angle, mu_h = -sqrt(1 - (R/r)^2), R the
///   ground's radius and r that of x. For a = 0, v is 1 above the horizon and 0 below.
/// - Scattered light is that of a sun reduced to a point at its centre.
/// - The ground is Lambertian.
struct Atmosphere {
  std::string name;  ///< for people

  /// Wavelengths, increasing or decreasing, 1 to 1e6 nm. `SkyColour::spectral` requires three, one per channel (red,
  /// green, blue); `SkyColour::linear_srgb` integrates 3 to 96.
  std::vector<double> wavelengths_nm{680.0, 550.0, 440.0};

  double bottom_radius_m = 6'360'000.0;  ///< radius of the ground, where the air begins
  double top_radius_m = 6'420'000.0;     ///< radius of the top of the air

  Constituent rayleigh;                                        ///< scatters as 3 / (16 pi) (1 + cos^2)
  Constituent aerosol;                                         ///< Mie scatterer
  AerosolPhase aerosol_phase = AerosolPhase::cornette_shanks;  ///< phase function of the aerosol
  double aerosol_asymmetry = 0.8;                              ///< asymmetry g, -0.8 to 0.999
  /// Asymmetry g per wavelength, -0.8 to 0.999; if empty, `aerosol_asymmetry` applies to all. Dust with a narrower lobe
  /// in blue gives Mars its blue aureole. With `SkyColour::linear_srgb`, each channel uses the mean g of its
  /// wavelengths.
  std::vector<double> aerosol_asymmetries;
  std::vector<Constituent> absorbers;  ///< absorbers such as ozone, without scattering; at most 4

  std::vector<double> ground_albedo;           ///< per wavelength, 0 to 1; empty for black
  std::vector<double> solar_irradiance;        ///< above the atmosphere, on a surface facing the sun, W/m2/nm
  double sun_angular_radius_degrees = 0.2678;  ///< 0 (a point) to 10

  /// Luminance of the zenith in a moonless night (airglow, zodiacal light, faint stars), seen from the ground, 0
  /// (none) to 1 cd/m2. Views from within the air add it by night and by day, to radiance, irradiance, harmonics
  /// and curves. Tables do not contain it, nor does the reference. docs/maths/sky.md describes its colour and
  /// shape.
  double night_zenith_luminance = 0.0;

  friend bool operator==(const Atmosphere&, const Atmosphere&) = default;
};

/// Checks an atmosphere: all values are finite; lists have one entry per wavelength; coefficients are 0 to 1e6,
/// irradiances 0 to 1e12, bottom_radius_m 1 to 1e9; top_radius_m is above bottom_radius_m and at most 11 times it; g is
/// -0.8 to 0.999; there are at most 4 absorbers and 8 layers, with thicknesses of 0 to 1e12 and terms up to 1e15.
/// Otherwise throws `Error` (invalid_argument) that names the parameter, its value and the allowed range.
void check(const Atmosphere& atmosphere);

/// Aerosols of Earth's air, with their optical depth at 550 nm.
enum class AerosolKind {
  clear,     ///< clear day, 0.1
  hazy,      ///< the aerosol of `clear` with 0.32
  dusty,     ///< desert dust, 0.5
  polluted,  ///< continental air near cities, 0.327, with more absorption
};

/// Returns "clear", "hazy", "dusty" or "polluted".
[[nodiscard]] const char* name(AerosolKind kind) noexcept;

/// An aerosol in terms of sun photometer measurements. Extinction follows Angstrom's law, (wavelength / 550
/// nm)^-exponent, with a Henyey-Greenstein phase function. The default is clear continental air.
struct AerosolModel {
  double optical_depth = 0.1;              ///< vertical extinction optical depth at 550 nm, 0 to 100
  double angstrom_exponent = 1.3;          ///< -4 to 8; 0 is grey, small particles have 1 to 2, dust about 0.2
  double single_scattering_albedo = 0.95;  ///< fraction of extinction that is scattering, 0 to 1
  double asymmetry = 0.7;                  ///< mean cosine of the scattering angle, -0.8 to 0.999
  double scale_height_m = 1200.0;          ///< 1 to 1e6

  friend bool operator==(const AerosolModel&, const AerosolModel&) = default;
};

/// Returns the parameters of a kind of aerosol. module/sky/planets.cpp cites where they come from. Throws `Error`
/// (invalid_argument) for an unknown kind.
[[nodiscard]] AerosolModel aerosol_model(AerosolKind kind);

/// Returns the atmosphere with another aerosol. Throws `Error` (invalid_argument) for values out of range.
[[nodiscard]] Atmosphere with_aerosol(Atmosphere atmosphere, const AerosolModel& aerosol);

/// Returns Earth's atmosphere at given wavelengths (360 to 830 nm) and with an aerosol. It has Rayleigh optical depth
/// 0.0973 at 550 nm (Hansen and Travis 1974), 300 Dobson units of ozone, solar spectrum ASTM G-173 and ground albedo
/// 0.1. The illuminance with clear air is within 10 % of the clear sky of IES RP-21-84 for suns at 60, 30 and 10
/// degrees (docs/maths/sky.md). Throws `Error` (invalid_argument) for other wavelengths and unknown kinds.
[[nodiscard]] Atmosphere earth(const std::vector<double>& wavelengths_nm = {680.0, 550.0, 440.0},
                               AerosolKind aerosol = AerosolKind::clear);
/// Returns the Earth of Bruneton 2017's program at given wavelengths (360 to 830 nm): Rayleigh 1.24062e-6 (1 um /
/// wavelength)^4, aerosols of scale height 1200 m and optical depth 0.0053 (far less than in clear air), an ozone tent
/// at 25 km. Throws `Error` (invalid_argument) for other wavelengths.
[[nodiscard]] Atmosphere earth_bruneton(const std::vector<double>& wavelengths_nm = {680.0, 550.0, 440.0});
/// Returns Hillaire 2020's Earth ("A Scalable and Production Ready Sky and Atmosphere Rendering Technique", table 1).
[[nodiscard]] Atmosphere earth_hillaire();
/// Returns Mars: thin carbon dioxide, and dust of optical depth 0.5 that absorbs blue.
[[nodiscard]] Atmosphere mars();
/// Returns the atmosphere without its aerosol.
[[nodiscard]] Atmosphere without_aerosol(Atmosphere atmosphere);
/// Returns the atmosphere with a grey ground of the given albedo, 0 to 1.
[[nodiscard]] Atmosphere with_ground_albedo(Atmosphere atmosphere, double albedo);

/// Meaning of the three channels of a computed sky.
enum class SkyColour {
  spectral,     ///< W/m2/sr/nm at three wavelengths, in the order of `wavelengths_nm`
  linear_srgb,  ///< cd/m2 in linear sRGB: the spectrum integrated with the CIE 1931 colour matching functions, 683 lm/W
};

/// Returns the unit direction towards a sun. Elevation is -90 to 90 degrees; azimuth, from +z towards +x, -1e6 to 1e6
/// degrees. Throws `Error` (invalid_argument).
[[nodiscard]] dvec3 sun_direction(double elevation_degrees, double azimuth_degrees);

// ---- The sun by date and place

/// Returns the seconds from 1970-01-01T00:00Z to a date, without leap seconds (POSIX). `date` is in the form of RFC
/// 3339 and ISO 8601: "2026-06-21T18:30Z", "2026-06-21 20:30:15.5+02:00". Seconds may be omitted; the time zone may
/// not. The leap second 23:59:60Z counts as the second after it. Throws `Error` (invalid_argument) that says what is
/// wrong.
[[nodiscard]] double unix_seconds(std::string_view date);

/// Place from which the sun is seen, its axes, and refraction.
struct SunObserver {
  double latitude_degrees = 0.0;   ///< geographic, positive in the north, -90 to 90
  double longitude_degrees = 0.0;  ///< positive in the east, -360 to 360
  /// Azimuth of north, from +z towards +x, -1e6 to 1e6. 180: north is -z, east +x and south +z, as in Blender's glTF.
  double north_azimuth_degrees = 180.0;
  /// Raises the sun to where it is seen through air (Saemundsson 1986): by 0.48 degrees on the horizon. Computed skies
  /// have straight rays.
  bool refraction = false;
  double pressure_hpa = 1010.0;       ///< pressure at the observer for refraction, 0 to 2000
  double temperature_celsius = 10.0;  ///< temperature at the observer for refraction, -120 to 100

  friend bool operator==(const SunObserver&, const SunObserver&) = default;
};

/// Position of the centre of the sun's disc.
struct SunPosition {
  double elevation_degrees = 0.0;   ///< above the horizontal plane, including refraction
  double azimuth_degrees = 0.0;     ///< from +z towards +x, as in `sun_direction`, -180 to 180
  double compass_degrees = 0.0;     ///< from north through east, 0 to 360
  double refraction_degrees = 0.0;  ///< part of the elevation that is due to refraction
  double distance_au = 0.0;         ///< distance, astronomical units; irradiance varies as 1 / distance^2
  dvec3 direction{};                ///< unit direction towards the sun
};

/// Computes the sun's position from 1900 to 2099, after Reda and Andreas 2004. From 1950 to 2050 it is within 0.002
/// degrees of astropy's (docs/guides/moving_sky.md); UTC is taken for UT1, which differs by up to 0.004 degrees of
/// rotation. With refraction the elevation is within 0.01 degrees of astropy's above 5 degrees. Throws `Error`
/// (invalid_argument) for a date or an observer out of range.
[[nodiscard]] SunPosition sun_position(double unix_seconds, const SunObserver& observer);
/// Computes the sun's position at a date that `unix_seconds` reads.
[[nodiscard]] SunPosition sun_position(std::string_view date, const SunObserver& observer);

// ---- Precomputed scattering (Bruneton and Neyret 2008; Bruneton 2017)

/// Dimensions of the table of scattered light.
enum class ScatteringLayout {
  /// Altitude, and the cosines of three angles: the view's zenith angle, the sun's zenith angle, and the azimuth
  /// between view and sun (for which Bruneton uses the angle between view and sun).
  full,
  /// Altitude and the two zenith angles: the azimuth enters only through phase functions (Bruneton and Neyret 2008,
  /// 32 x 64 x 32 texels). rgb holds Rayleigh and all higher orders; a holds the first channel of single Mie
  /// scattering, from which the other channels are extrapolated.
  compact,
};

/// Sizes of the scattering tables, orders of scattering, and colours.
struct SkyTableOptions {
  ScatteringLayout layout = ScatteringLayout::full;  ///< dimensions of the scattering table
  int heights = 32;                                  ///< altitudes of the scattering table, 2 to 128
  int view_zeniths = 64;                             ///< even, 4 to 1024; half of them for rays that hit the ground
  int sun_zeniths = 64;                              ///< 4 to 256
  int sun_angles = 8;                                ///< azimuths between view and sun, `full` only: 2 to 128
  int transmittance_heights = 64;                    ///< 2 to 1024
  int transmittance_zeniths = 256;                   ///< 2 to 2048
  int irradiance_heights = 16;                       ///< 2 to 1024
  int irradiance_sun_zeniths = 64;                   ///< 2 to 1024

  /// Elevation of the lowest sun in the tables, -90 to 0 degrees. The sky of a sun below it is that of the lowest sun,
  /// faded to black at the nadir.
  double minimum_sun_elevation_degrees = -30.0;

  int orders = 4;  ///< orders of scattering including ground reflections, 1 (single) to 64

  /// Stops early after an order whose mean radiance is below this fraction of that of all orders before it, over
  /// all altitudes and suns; 0 never stops early. With `linear_srgb`, each group of three wavelengths stops separately,
  /// and `SkyTables::orders` is the maximum.
  double convergence_threshold = 0.0;

  /// True: ignores orders beyond `orders`. False: estimates their contribution, if `orders` is above 1. It matters in
  /// deep twilight, in thick air and over bright ground.
  bool truncate_orders = false;

  SkyColour colour = SkyColour::spectral;                      ///< three wavelengths, or linear sRGB
  std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U;  ///< tables that need more throw `Error` (limit_exceeded)

  friend bool operator==(const SkyTableOptions&, const SkyTableOptions&) = default;
};

/// Scattering tables of an atmosphere. Channels are three wavelengths or linear sRGB (`options.colour`).
struct SkyTables {
  Atmosphere atmosphere;    ///< the atmosphere that they were computed from
  SkyTableOptions options;  ///< options of the tables

  /// Transmittance to the top, for rays that miss the ground: [transmittance_heights][transmittance_zeniths][3]. With
  /// `linear_srgb`: transmitted sunlight in sRGB, relative to sunlight above the air.
  std::vector<float> transmittance;

  /// Scattered light, [heights][view_zeniths][sun_angles][sun_zeniths][4]: a texture of sun_angles * sun_zeniths x
  /// view_zeniths x heights RGBA texels. rgb holds Rayleigh scattering without its phase function plus higher orders
  /// divided by that function, both times solar irradiance. a holds the first channel of single Mie scattering without
  /// its phase function. With `compact`, sun_angles counts as 1.
  std::vector<float> scattering;

  /// Single Mie scattering in three channels and a zero, in the shape of `scattering`. Empty for the compact layout,
  /// and without an aerosol that scatters.
  std::vector<float> single_mie;

  /// Irradiance of the sky, without direct sunlight, on horizontal ground:
  /// [irradiance_heights][irradiance_sun_zeniths][3].
  std::vector<float> irradiance;

  int orders = 0;                  ///< orders that were computed
  double last_change = 0.0;        ///< fraction that the last order added
  std::vector<PassRecord> passes;  ///< wall time of each step

  /// Returns the size of all tables in bytes.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
};

/// Computes scattering tables. Cost per three wavelengths: 2 to 3 s of CPU time with the defaults, a third of that with
/// one order. Small tables are computed from fewer nodes. All values are finite and not negative.
///
/// Single scattering at texels has a root mean square error of 1e-5 of the mean by day and 1e-4 by night (Earth, Mars).
/// For higher orders, Bruneton integrates over all directions for each direction. Welkin projects the radiance around a
/// point to spherical harmonics about the vertical (20 bands; 28 for narrow lobes), where a phase function is one
/// factor per band. The second order agrees with direct integration to 0.5 %. The part of a forward lobe that these
/// bands cannot represent counts as unscattered light (delta-M scaling), also in the first order unless `orders` is 1.
///
/// Throws `Error`: invalid_argument, limit_exceeded.
[[nodiscard]] SkyTables precompute_sky(const Atmosphere& atmosphere, const SkyTableOptions& options = {},
                                       const Control& control = {});

/// Returns tables of a sky between others in which one property differs, such as the ground's albedo or the amount of
/// haze: a polynomial through `tables` at `positions`, evaluated at `position`. Transmittance is that of `atmosphere`,
/// exactly. Cost: 5 ms of CPU time for compact tables, 35 ms for full ones. Root mean square error by compact tables of
/// the Earth at three places: 6e-4 between grounds (albedo 0.6 by 0, 0.4 and 0.8), 6e-3 between hazes (1.4 times as
/// much by 0.5, 1 and 2). `tables` must have the same options, and atmospheres of the same size, wavelengths and
/// constituents. Throws `Error` (invalid_argument), also for places that are equal.
[[nodiscard]] SkyTables interpolate_sky(const Atmosphere& atmosphere, std::span<const SkyTables> tables,
                                        std::span<const double> positions, double position,
                                        const Control& control = {});

// ---- The sky seen from one altitude, in any direction and for any sun

/// Options of `SkyView`.
struct SkyViewOptions {
  bool ground = true;  ///< includes the ground, lit by sun and sky; otherwise rays that hit it see only the air
};

/// Options of sky images.
struct SkyImageOptions {
  /// Includes the sun's disc, antialiased by covered area. Its total radiance equals the irradiance of
  /// `SkyView::sun_light`.
  bool sun_disc = false;
};

/// A slice of scattering tables at one altitude. Memory: 1 MiB at the default sizes; cost: 2 ms. Immutable. Calls throw
/// `Error` (invalid_argument) for a sun direction that is zero or not finite.
///
/// Radiance between nodes of the tables is interpolated by cubics in altitude, view zenith, azimuth and sun zenith,
/// which overshoot the two nearest nodes by at most a tenth of their range. Errors relative to the reference for single
/// scattering (Earth, default sizes): of nine harmonics, for suns from 90 to -8 degrees, 0.2 % on the ground, 0.3 % at
/// 20 km and 0.7 % at the top of the air; of radiance (rms), 1e-5 by day, 0.5 % at and after sunset, and several
/// percent at the edges of the planet's shadow.
///
/// Copies share the tables. A view that was moved from can only be assigned to or destroyed.
class SkyView {
 public:
  /// Creates a view from an altitude of 0 (on the ground) to 1e9 m. Above the top of the air, a ray starts where it
  /// enters the air. Throws `Error` (invalid_argument), also for tables whose contents do not match their options.
  SkyView(std::shared_ptr<const SkyTables> tables, double altitude_m, const SkyViewOptions& options = {});

  /// Returns the tables of the view.
  [[nodiscard]] const std::shared_ptr<const SkyTables>& tables() const noexcept;
  /// Returns the altitude of the observer above the ground.
  [[nodiscard]] double altitude_m() const noexcept;

  /// Returns the radiance from a direction, without the sun's disc; finite and not negative. For a sun below
  /// the tables' lowest, returns the sky of that lowest sun, dimmed to black for a sun at the nadir. Does not allocate.
  /// Cost: 0.3 us. Throws `Error` (invalid_argument) for directions that are zero or not finite.
  [[nodiscard]] dvec3 radiance(const dvec3& direction, const dvec3& sun) const;

  /// Computes radiance for many directions with SIMD; bit-identical to the call above for the same floats. Does not
  /// allocate. Cost: 50 ns per direction. Throws `Error` (invalid_argument) if `rgb` is shorter than `directions`.
  void radiance(std::span<const vec3> directions, const dvec3& sun, std::span<vec3> rgb) const;

  /// Returns the sun as a directional light at this altitude: direction, irradiance through the air (0 below the
  /// horizon, reduced while the disc sets), mean radiance and solid angle of its disc. `texels` and total radiances are
  /// not set.
  [[nodiscard]] Sun sun_light(const dvec3& sun) const;

  /// Returns the irradiance of the sky, without direct sunlight, on a horizontal surface facing up, from the table.
  /// Includes the light of the night sky within the air; 0 above it.
  [[nodiscard]] dvec3 irradiance(const dvec3& sun) const;

 private:
  struct WELKIN_HIDDEN Slice;
  friend struct SkyViewAccess;  ///< module/sky: gives quadratures access to the slice
  std::shared_ptr<const Slice> slice_;
};

/// Computes an image of the sky: each texel has the radiance at its centre. With `options.sun_disc`, texels also have
/// the disc's radiance times the fraction of their area that it covers. The disc's radiance times solid angle, summed
/// over the image, is the irradiance of `SkyView::sun_light` at any image size. The part of a disc below the horizon is
/// left out. Cost: 50 ns and 12 bytes per texel. Throws `Error` (invalid_argument) unless size or height is 1 to 16384.
[[nodiscard]] Cubemap sky_cubemap(const SkyView& view, const dvec3& sun, int size, const SkyImageOptions& options = {},
                                  const Control& control = {});
[[nodiscard]] LatLongImage sky_lat_long(const SkyView& view, const dvec3& sun, int height,
                                        const SkyImageOptions& options = {}, const Control& control = {});

// ---- A computed sky as spherical harmonics: by quadrature, or from a curve over the sun's elevation
//
//   welkin::SkyCurve curve(view);                                          // milliseconds, once per altitude
//   welkin::SphericalHarmonics light = curve.at(welkin::sun_direction(20.0, 145.0));  // each frame

/// Directions and weights of a sky projection. A sky is mirror-symmetric about the sun's vertical plane, so only half
/// of the azimuths are evaluated, and coefficients that are odd in the azimuth from the sun are 0.
enum class SkyQuadrature {
  /// Uniform in angles, weighted by solid angle. The article uses 16 zenith angles x 32 azimuths (16 evaluated).
  uniform,
  /// Gauss-Legendre in t on each side of the horizon, at zenith cosines horizon +- t^2; trapezoid in azimuth.
  gauss,
  /// `gauss` with azimuths closer together near the sun (tan(azimuth / 2) = A tan(t / 2), trapezoid in t). The
  /// aerosol's forward lobe around the sun is subtracted before quadrature, and its harmonics are added in closed
  /// form.
  gauss_split,
};

/// Returns "uniform", "gauss" or "gauss-split".
[[nodiscard]] const char* name(SkyQuadrature quadrature) noexcept;

/// Options of `SkyProjector`.
struct SkyHarmonicsOptions {
  int bands = 3;                                          ///< 1 to kMaximumBands
  SkyQuadrature quadrature = SkyQuadrature::gauss_split;  ///< placement of directions
  int zeniths = 16;   ///< zenith angles on each side of the horizon, 2 to 128; for `uniform`, on both together
  int azimuths = 16;  ///< azimuths over half the circle, 2 to 256; the other half is its mirror image

  friend bool operator==(const SkyHarmonicsOptions&, const SkyHarmonicsOptions&) = default;
};

/// A quadrature of a view's sky, with all that does not depend on the sun computed once. Immutable.
///
/// Relative error of nine coefficients (Bruneton's Earth, default options) against the converged integral of the view:
/// on the ground 2.1e-4 for suns from 90 to -6 degrees and 3e-3 at -10 degrees; at -6 degrees, 2.2e-3 at 10 km and
/// 6.4e-3 at 50 km. The article's directions err by 2e-2 to 1.3e-1. Narrower lobes: 5e-3 at g = 0.95, and up to 7e-2 at
/// g = 0.99 while the sun crosses the horizon. Above the air the lobe is not subtracted, and a projection costs 50
/// times as much.
class SkyProjector {
 public:
  /// Prepares a quadrature. Throws `Error`: invalid_argument, limit_exceeded (more than 1 GiB of prepared data).
  explicit SkyProjector(SkyView view, const SkyHarmonicsOptions& options = {});

  /// Computes radiance coefficients of the sky for a sun direction, without the sun's disc. Writes bands^2 triples.
  /// Does not allocate. Throws `Error` (invalid_argument) if the span is too short or the direction is zero or not
  /// finite.
  void project(const dvec3& sun, std::span<dvec3> coefficients) const;
  /// Returns radiance coefficients of the sky for a sun direction, without the sun's disc.
  [[nodiscard]] SphericalHarmonics project(const dvec3& sun) const;

  [[nodiscard]] int directions() const noexcept;  ///< returns the number of radiance evaluations per projection
  /// Returns the view that is projected.
  [[nodiscard]] const SkyView& view() const noexcept;
  /// Returns the options of the quadrature.
  [[nodiscard]] const SkyHarmonicsOptions& options() const noexcept;

 private:
  struct WELKIN_HIDDEN Prepared;
  friend struct SkyProjectorAccess;  ///< module/sky: coefficients before rotation
  std::shared_ptr<const Prepared> prepared_;
};

/// Options of `SkyCurve`.
struct SkyCurveOptions {
  int bands = 3;    ///< 1 to kMaximumBands; `projection.bands` is ignored
  int nodes = 256;  ///< number of sun elevations, denser near the horizon: 8 to 4096
  /// Quadrature at each node.
  SkyHarmonicsOptions projection{.bands = 3, .quadrature = SkyQuadrature::gauss_split, .zeniths = 32, .azimuths = 32};

  friend bool operator==(const SkyCurveOptions&, const SkyCurveOptions&) = default;
};

/// Harmonics as a function of the sun's elevation at one altitude, interpolated and rotated about the vertical for any
/// sun. Band 0 and the sun's irradiance are never negative. Immutable; copies share the data.
///
/// Error relative to `SkyProjector` on the ground, with the default 256 nodes, by the lowest elevation of the sun: 4e-4
/// to -6 degrees, 6e-3 to -9, 2e-2 to -12, and 1e-1 to -18. At such low suns the tables themselves are no smoother.
/// Direct sunlight agrees with the view's to 1e-3, also while the disc sets.
class SkyCurve {
 public:
  /// Computes the curve, in parallel over elevations. Throws `Error`: invalid_argument, limit_exceeded.
  explicit SkyCurve(const SkyView& view, const SkyCurveOptions& options = {}, const Control& control = {});

  /// Returns the number of bands.
  [[nodiscard]] int bands() const noexcept;
  /// Computes radiance coefficients for a sun direction. Writes bands^2 triples. Does not allocate. Cost: below 1 us
  /// for 3 bands. Throws `Error` (invalid_argument) if the span is too short or the direction is zero or not finite.
  void at(const dvec3& sun, std::span<dvec3> coefficients) const;
  /// Returns radiance coefficients for a sun direction. Cost: microseconds.
  [[nodiscard]] SphericalHarmonics at(const dvec3& sun) const;
  /// Returns the irradiance of direct sunlight on a surface facing the sun.
  [[nodiscard]] dvec3 sun_irradiance(const dvec3& sun) const;

  /// Returns the size of the curve in bytes.
  [[nodiscard]] std::uint64_t bytes() const noexcept;

 private:
  struct WELKIN_HIDDEN Nodes;
  std::shared_ptr<const Nodes> nodes_;
};

}  // namespace welkin
