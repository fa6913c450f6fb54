// Computed skies: tables of a planet's scattered light, the sky as it is seen from one height, and its harmonics.
//
//   auto tables = std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth()));   // seconds
//   welkin::SkyView view(tables, 0.0);                                     // milliseconds, once a height
//   welkin::dvec3 sun = welkin::sun_direction(20.0, 145.0);
//   welkin::Cubemap picture = welkin::sky_cubemap(view, sun, 256);
//   welkin::SphericalHarmonics light = welkin::SkyProjector(view).project(sun);
//
// Directions have y up, and a direction `sun` points towards the sun; a sun's azimuth is counted from +z towards
// +x, its elevation from the horizon up. Lengths are metres, coefficients 1/m, wavelengths nanometres, irradiances
// W/m2/nm.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- Atmospheres as data: what a planet's air scatters and absorbs, and the light that falls on it

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

// ---- Precomputed scattering (Bruneton and Neyret 2008; Bruneton 2017)

/// How many dimensions the table of scattered light has.
enum class ScatteringLayout {
  /// Height x cosine of view's zenith x cosine of sun's zenith x cosine of the azimuth between view and sun (Bruneton,
  /// who has the cosine between view and sun for the last).
  full,
  /// Without the last: what varies with it is but the phase functions (32 x 64 x 32 in the article). RGBA: Rayleigh and
  /// all higher orders in rgb, the first channel of single Mie scattering in a; its other channels are extrapolated.
  compact,
};

/// Sizes of the tables, and how far the scattering is followed.
struct SkyTableOptions {
  ScatteringLayout layout = ScatteringLayout::full;  ///< four-dimensional, or compact
  int heights = 32;                                  ///< of the scattering table, 2 to 128
  int view_zeniths = 64;                             ///< even, 4 to 1024: half of them for rays that meet the ground
  int sun_zeniths = 64;                              ///< 4 to 256
  int sun_angles = 8;                                ///< cosines of azimuths between view and sun, full only: 2 to 128
  int transmittance_heights = 64;                    ///< 2 to 1024
  int transmittance_zeniths = 256;                   ///< 2 to 2048
  int irradiance_heights = 16;                       ///< 2 to 1024
  int irradiance_sun_zeniths = 64;                   ///< 2 to 1024

  /// Elevation of the lowest sun that tables hold, in degrees, -90 to 0. The sky of a sun below it is that of the
  /// lowest one, faded to nothing.
  double minimum_sun_elevation_degrees = -30.0;

  int orders = 4;  ///< of scattering, ground reflections included: 1 (single) to 64

  /// Stops before `orders` when an order added less than this share of all light before it (mean radiance, over all
  /// heights and suns). 0: never. Folded spectra stop three wavelengths at a time: `orders` is then the largest number
  /// of the three.
  double until_change = 0.0;

  /// Of orders beyond `orders` nothing is in the tables. Off: if there is more than one order, what all further ones
  /// add is estimated, as light in deep twilight has been scattered often.
  bool exact_orders = false;

  SkyColour colour = SkyColour::spectral;                      ///< wavelengths, or three primaries
  std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U;  ///< tables that need more are refused

  friend bool operator==(const SkyTableOptions&, const SkyTableOptions&) = default;
};

/// The tables. Channels are three wavelengths' or linear sRGB's (`options.colour`).
struct SkyTables {
  Atmosphere atmosphere;    ///< what they were computed from
  SkyTableOptions options;  ///< those that they were made with

  /// Transmittance to the top (not past the ground): [transmittance_heights][transmittance_zeniths][3]. Of spectra that
  /// are folded: sRGB light of a white sun (the sun's own spectrum folded) through it, relative to that above the air.
  std::vector<float> transmittance;

  /// [heights][view_zeniths][sun_angles][sun_zeniths][4], as a texture of sun_angles * sun_zeniths x view_zeniths x
  /// heights RGBA: Rayleigh scattering without its phase function and higher orders divided by it, times solar
  /// irradiance; in a single Mie scattering's first channel, likewise without phase function.
  std::vector<float> scattering;

  /// Full layout: single Mie scattering's channels (and 0), same shape. Compact, or no aerosol that scatters: empty.
  std::vector<float> single_mie;

  /// Irradiance of the sky, without direct sun, on horizontal ground facing up: [irradiance_heights]
  /// [irradiance_sun_zeniths][3].
  std::vector<float> irradiance;

  int orders = 0;                  ///< that were computed
  double last_change = 0.0;        ///< share that the last of them added
  std::vector<PassRecord> passes;  ///< wall time of each step

  /// Memory of all tables.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
};

/// Memory that `precompute_sky` needs at most, results included; some 1 MB of it for each thread of the caller's arena.
/// Throws `Error` (invalid_argument), also for radiances of other than three wavelengths.
[[nodiscard]] std::uint64_t sky_table_bytes(const Atmosphere& atmosphere, const SkyTableOptions& options);

/// Precomputes: about two seconds of processor time for the defaults, a third of it for one order; three wavelengths
/// each. Small tables are computed from fewer nodes.
///
/// Single scattering at texels: root mean square error 1e-5 of the mean by day, 1e-4 by night (Earth, Mars). Higher
/// orders are not integrated over directions for each direction, as Bruneton does it: radiance about a point is
/// projected to spherical harmonics (20 bands, of narrow lobes 28) about the vertical, where phase functions are
/// products; the second order agrees with direct integration to 0.5 %. What these bands cannot carry of a forward lobe
/// is taken for light that goes straight on (delta-M scaling), in the first order too, unless `orders` is 1.
///
/// The same bits on any number of threads and instruction set. Nothing in them is negative or not finite.
/// Throws `Error`: invalid_argument, limit_exceeded, cancelled.
[[nodiscard]] SkyTables precompute_sky(const Atmosphere& atmosphere, const SkyTableOptions& options = {},
                                       const Control& control = {});

// ---- The sky as it is seen from one height: any direction, any sun

/// What a view is prepared for.
struct SkyViewOptions {
  bool ground = true;  ///< rays that end on the ground see it, lit by sun and sky; else only the air before it
};

/// What pictures show.
struct SkyPictureOptions {
  /// The sun's disc, as texels that it covers by area: their total radiance is the directional light's irradiance. Off:
  /// the disc is left out.
  bool sun_disc = false;
};

/// The tables' slice at one height: 1 MiB at the default sizes, made in some 2 ms. Immutable: any number of threads may
/// ask at once. A sun that is not finite or has no length is an `Error` (invalid_argument) in every call that takes
/// one.
///
/// Between the tables' nodes radiance is a cubic along each of height, view zenith, azimuth and sun zenith, which
/// leaves the range of the two nodes nearest to it by no more than a tenth. Measured against the truth of single
/// scattering (Earth, default sizes): nine harmonics within 0.2 % from 90 to -8 degrees on the ground, 0.3 % at 20 km,
/// 0.7 % at the top; radiance rms 1e-5 by day, 0.5 % at sunset and after; at the edges of the planet's shadow percents.
class SkyView {
 public:
  /// Altitude 0 (on the ground) to 1e9 m: above the top it is space, and rays are looked up where they enter the air.
  /// Throws `Error` (invalid_argument), also for tables that do not hold what their options say.
  SkyView(std::shared_ptr<const SkyTables> tables, double altitude_m, const SkyViewOptions& options = {});
  ~SkyView();
  /// Copies share the tables.
  SkyView(const SkyView&);
  /// The source can only be assigned to or destroyed afterwards.
  SkyView(SkyView&&) noexcept;
  /// As the constructors.
  SkyView& operator=(const SkyView&);
  /// As the constructors.
  SkyView& operator=(SkyView&&) noexcept;

  /// The tables that the view is a slice of.
  [[nodiscard]] const std::shared_ptr<const SkyTables>& tables() const noexcept;
  /// The observer's, above the ground.
  [[nodiscard]] double altitude_m() const noexcept;

  /// Returns the radiance that arrives from a direction, without the sun's disc; `sun`: towards the sun. It is finite
  /// and not negative. Below the lowest sun of the tables it is the sky of that sun, faded to nothing at the nadir.
  /// Allocates nothing. Cost: 0.3 us. Throws `Error` (invalid_argument) for directions that are zero or not finite.
  [[nodiscard]] dvec3 radiance(const dvec3& direction, const dvec3& sun) const;

  /// The same for many directions, in lanes: packed x y z, packed rgb. The bits of the call above for the same floats.
  /// Allocates nothing; some 50 ns a direction. Throws `Error` (invalid_argument) if `rgb` is shorter than
  /// `directions`.
  void radiance(std::span<const vec3> directions, const dvec3& sun, std::span<vec3> rgb) const;

  /// The sun as a directional light at this height: direction, irradiance through the air (0 below the horizon, in part
  /// while it sets), mean radiance, solid angle of its disc. `texels` and total radiances are not set.
  [[nodiscard]] Sun sun(const dvec3& sun) const;

  /// Irradiance of the sky (no direct sun) on a horizontal surface facing up, from the table, with the light of the
  /// night if the atmosphere has any; 0 from above the air.
  [[nodiscard]] dvec3 irradiance(const dvec3& sun) const;

 private:
  struct WELKIN_HIDDEN Slice;
  friend struct SkyViewAccess;  ///< module/sky: the slice for quadratures
  std::shared_ptr<const Slice> slice_;
};

/// The radiance at texels' centres (the sun's disc, if asked for, by area: its total radiance is the irradiance of
/// `SkyView::sun` at any size; of a disc that the horizon cuts the part above). Parallel over rows, the same bits on
/// any number of threads; some 50 ns and 12 bytes a texel. Throws `Error`: invalid_argument (size or height 1 to
/// 16384), cancelled.
[[nodiscard]] Cubemap sky_cubemap(const SkyView& view, const dvec3& sun, int size,
                                  const SkyPictureOptions& options = {}, const Control& control = {});
[[nodiscard]] LatLongImage sky_lat_long(const SkyView& view, const dvec3& sun, int height,
                                        const SkyPictureOptions& options = {}, const Control& control = {});

// ---- A computed sky as spherical harmonics: by quadrature, or along a curve over the sun's elevation, baked once
//
//   welkin::SkyCurve curve(view);                                          // milliseconds, once a height
//   welkin::SphericalHarmonics light = curve.at(welkin::sun_direction(20.0, 145.0));  // each frame

/// Directions and weights. A sky is mirror-symmetric about the sun's vertical plane, so all of them look at half the
/// azimuths only, and no coefficient that is odd in the azimuth from the sun is computed.
enum class SkyQuadrature {
  /// Uniform in angles, weighted by solid angle: 16 zenith angles x 32 azimuths (16 looked at) are the article's
  uniform,
  /// Gauss-Legendre in t, cosine = horizon +- t^2, on either side of the horizon, times a trapezoid in azimuth
  gauss,
  /// The same zenith angles, azimuths closer together about the sun (tan(azimuth / 2) = A tan(t / 2), trapezoid in t),
  /// and the aerosol's forward lobe, times what it has to scatter at the sun, taken out of the sky and given back by
  /// its own spectrum in closed form
  gauss_split,
};

/// "uniform", "gauss", "gauss-split"
[[nodiscard]] const char* name(SkyQuadrature quadrature) noexcept;

/// How a sky is projected.
struct SkyHarmonicsOptions {
  int bands = 3;                                          ///< 1 to kMaximumBands
  SkyQuadrature quadrature = SkyQuadrature::gauss_split;  ///< where directions are taken
  int zeniths = 16;   ///< Gauss nodes on either side of the horizon; uniform: over both. 2 to 128
  int azimuths = 16;  ///< over half the circle, mirrored: 2 to 256

  friend bool operator==(const SkyHarmonicsOptions&, const SkyHarmonicsOptions&) = default;
};

/// A quadrature made ready for a view: what does not depend on the sun is computed here. Immutable: any number of
/// threads may ask at once.
///
/// Error of the nine coefficients of Bruneton's Earth at the default setting, against the converged integral of the
/// same view, on the ground: 2.1e-4 from 90 to -6 degrees, 3e-3 at -10; the article's directions: 2e-2 to 1.3e-1. At
/// 10 km 2.2e-3, at 50 km 6.4e-3 (both at -6). Sharper lobes: 5e-3 at g = 0.95; at 0.99 up to 7e-2 while the sun
/// crosses the horizon. Outside of the atmosphere the lobe is not taken out, and an update costs some 50 times more.
class SkyProjector {
 public:
  /// Throws `Error`: invalid_argument, limit_exceeded (more than 1 GiB for what is made ready).
  explicit SkyProjector(SkyView view, const SkyHarmonicsOptions& options = {});

  /// Radiance coefficients of the sky with the sun towards a direction, without its disc. Writes bands^2 triples;
  /// allocates nothing. The same bits on every instruction set. Throws `Error` (invalid_argument) for too short a span,
  /// a direction that is not finite or has no length.
  void project(const dvec3& sun, std::span<dvec3> coefficients) const;
  /// Harmonics of radiance for one direction to the sun, without the sun's disc.
  [[nodiscard]] SphericalHarmonics project(const dvec3& sun) const;

  [[nodiscard]] int directions() const noexcept;  ///< radiance evaluations an update
  /// The view that is projected.
  [[nodiscard]] const SkyView& view() const noexcept;
  /// Those that it was made with.
  [[nodiscard]] const SkyHarmonicsOptions& options() const noexcept;

 private:
  struct WELKIN_HIDDEN Prepared;
  friend struct SkyProjectorAccess;  ///< module/sky: coefficients before they are turned
  std::shared_ptr<const Prepared> prepared_;
};

/// How many nodes a curve has, and how each is made.
struct SkyCurveOptions {
  int bands = 3;    ///< 1 to kMaximumBands; `projection.bands` is not read
  int nodes = 256;  ///< sun elevations, closer together about the horizon: 8 to 4096
  /// How each node is projected.
  SkyHarmonicsOptions projection{.bands = 3, .quadrature = SkyQuadrature::gauss_split, .zeniths = 32, .azimuths = 32};

  friend bool operator==(const SkyCurveOptions&, const SkyCurveOptions&) = default;
};

/// Coefficients over the sun's elevation at one height, baked once: a moved sun is an interpolation and a turn
/// about the vertical. Band 0 and the sun's irradiance are never negative. Immutable; copies share it.
///
/// Against the projection it is made of, at the default 256 nodes on the ground: 4e-4 from 90 to -6 degrees, 6e-3 to
/// -9, 2e-2 to -12, 1e-1 to -18, where the tables' own interpolation between suns is no smoother than that. The direct
/// sun agrees with the view's to 1e-3, also while its disc sets.
class SkyCurve {
 public:
  /// Parallel over elevations; the same bits on any number of threads and instruction set.
  /// Throws `Error`: invalid_argument, limit_exceeded, cancelled.
  explicit SkyCurve(const SkyView& view, const SkyCurveOptions& options = {}, const Control& control = {});

  /// Bands of the harmonics.
  [[nodiscard]] int bands() const noexcept;
  /// Writes bands^2 triples; allocates nothing; under a microsecond for 3 bands. Throws `Error` (invalid_argument) for
  /// too short a span, a direction that is not finite or has no length.
  void at(const dvec3& sun, std::span<dvec3> coefficients) const;
  /// Harmonics of radiance for a direction to the sun. Cost: microseconds.
  [[nodiscard]] SphericalHarmonics at(const dvec3& sun) const;
  /// The direct sun's irradiance on a surface that faces it, from the same curve.
  [[nodiscard]] dvec3 sun_irradiance(const dvec3& sun) const;

  /// Memory of the curve.
  [[nodiscard]] std::uint64_t bytes() const noexcept;

 private:
  struct WELKIN_HIDDEN Nodes;
  std::shared_ptr<const Nodes> nodes_;
};

}  // namespace welkin
