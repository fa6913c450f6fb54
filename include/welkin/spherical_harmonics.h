// Real spherical harmonics: coefficients, their basis, and operations on coefficients.
//
//   welkin::SphericalHarmonics irradiance = welkin::irradiance_from_radiance(light.radiance);
//   welkin::dvec3 ground = welkin::evaluate(irradiance, {0.0, 1.0, 0.0});   // W/m2 on a surface that faces up
//
// Convention: orthonormal real harmonics without Condon-Shortley phase, coefficient (l, m) at index l (l + 1) + m, Y(1,
// -1..1) proportional to y, z, x. engines.h converts to the conventions of engines.
#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"

namespace WELKIN_EXPORT welkin {

// ---- Coefficients and their values

/// Maximum number of bands. The highest band of `bands` is l = bands - 1.
inline constexpr int kMaximumBands = 16;

/// RGB coefficients of `bands` bands: bands^2 triples, initially zero. The call that returns them states whether they
/// are radiance or irradiance.
class SphericalHarmonics {
 public:
  /// Creates one band.
  SphericalHarmonics() : SphericalHarmonics(1) {}

  /// Creates `bands` bands. Throws `Error` (invalid_argument) unless 1 <= bands <= kMaximumBands.
  explicit SphericalHarmonics(int bands);

  /// Returns the number of bands; there are bands^2 coefficients.
  [[nodiscard]] int bands() const noexcept { return bands_; }

  /// Returns the coefficient of band l >= 0 and order -l <= m <= l, which are not checked.
  [[nodiscard]] const dvec3& at(int l, int m) const { return values_[index(l, m)]; }
  /// Returns a reference to the coefficient of band l >= 0 and order -l <= m <= l, which are not checked.
  [[nodiscard]] dvec3& at(int l, int m) { return values_[index(l, m)]; }

  /// Returns all coefficients, in the order of `index`.
  [[nodiscard]] std::span<const dvec3> coefficients() const noexcept { return values_; }
  /// Returns all coefficients for writing, in the order of `index`.
  [[nodiscard]] std::span<dvec3> coefficients() noexcept { return values_; }

  /// Returns the index of coefficient (l, m): l (l + 1) + m.
  [[nodiscard]] static constexpr std::size_t index(int l, int m) noexcept {
    return static_cast<std::size_t>(l * (l + 1) + m);
  }

 private:
  int bands_;
  std::vector<dvec3> values_;
};

/// Writes the bands^2 values Y(l, m), l < bands, of a direction. Error: below 5e-14 (5e-15 up to 8 bands), including
/// that of a rounded unit direction. Cost: 3 flops per value. Throws `Error` (invalid_argument) for an invalid number
/// of bands or direction, and for a span that is too short.
void evaluate_basis(const dvec3& direction, int bands, std::span<double> values);

/// Returns the sum of all coefficients times their basis functions at a direction: radiance from that direction, or
/// irradiance on a surface that faces it. Throws `Error` (invalid_argument) for an invalid direction.
[[nodiscard]] dvec3 evaluate(const SphericalHarmonics& coefficients, const dvec3& direction);
/// Writes the sums at many directions, the same bits as one by one. Cost: 10 ns per direction for three bands with
/// AVX2. Throws `Error` (invalid_argument) for an invalid direction, and for a span that is too short.
void evaluate(const SphericalHarmonics& coefficients, std::span<const dvec3> directions, std::span<dvec3> values);

/// Returns A_l, the cosine lobe's factor for band l >= 0: pi, 2 pi/3, pi/4, 0, -pi/24, 0, pi/64, ... (Ramamoorthi and
/// Hanrahan 2001, equations 8 and 9; odd bands above 1 are zero.)
[[nodiscard]] double cosine_lobe(int l);

/// Converts radiance to irradiance: multiplies band l by A_l. The unit is W/m2 where radiance is W/m2/sr.
[[nodiscard]] SphericalHarmonics irradiance_from_radiance(const SphericalHarmonics& radiance);

/// Converts irradiance to the radiance that a white Lambertian surface reflects: multiplies by 1/pi.
[[nodiscard]] SphericalHarmonics lambertian_from_irradiance(const SphericalHarmonics& irradiance);

/// Returns the mean radiance over the sphere, c(0,0) / sqrt(4 pi): the light of a scene with one ambient colour.
[[nodiscard]] dvec3 mean_radiance(const SphericalHarmonics& radiance);

// ---- Rotation and combination, in double precision, for any number of bands

/// A rotation as a quaternion of any length above 0. (GLM's own quaternions are not used in the interface, because
/// GLM_FORCE_QUAT_DATA_WXYZ changes the order of their members.)
struct Quaternion {
  double w = 1.0;  ///< cosine of half the angle
  double x = 0.0;  ///< x of the axis times the sine of half the angle
  double y = 0.0;  ///< y of the axis times the sine of half the angle
  double z = 0.0;  ///< z of the axis times the sine of half the angle
};

/// Rotates light: light from direction d then comes from rotation * d. Uses rotations about z and swaps of y and z
/// (Pinchon and Hoggan 2007). Error below 1e-13 for 16 bands; after 10 000 consecutive rotations, errors of
/// coefficients and of each band's power are below 1e-11. The quaternion is normalized first. Cost: 0.15 us for three
/// bands, 4 us for 16; the first call beyond four bands makes a table. Throws `Error` (invalid_argument) for a
/// quaternion of length 0.
[[nodiscard]] SphericalHarmonics rotate(const SphericalHarmonics& harmonics, const Quaternion& rotation);
/// Rotates light by a GLM quaternion: `rotate(harmonics, glm::angleAxis(angle, axis))`.
template <glm::qualifier Precision>
[[nodiscard]] SphericalHarmonics rotate(const SphericalHarmonics& harmonics,
                                        const glm::qua<double, Precision>& rotation) {
  return rotate(harmonics, Quaternion{.w = rotation.w, .x = rotation.x, .y = rotation.y, .z = rotation.z});
}

/// Rotates or mirrors light by an orthogonal matrix. The nearest orthogonal matrix is applied. Throws `Error`
/// (invalid_argument) if the matrix is off orthogonal by more than 1e-6.
[[nodiscard]] SphericalHarmonics rotate(const SphericalHarmonics& harmonics, const dmat3& rotation);

/// Returns a + b, with as many bands as the larger one; missing bands are zero.
[[nodiscard]] SphericalHarmonics add(const SphericalHarmonics& a, const SphericalHarmonics& b);
/// Returns factor * a, channel by channel.
[[nodiscard]] SphericalHarmonics scale(const SphericalHarmonics& a, const dvec3& factor);

/// Returns (1 - t) a + t b; t is not clamped.
[[nodiscard]] SphericalHarmonics lerp(const SphericalHarmonics& a, const SphericalHarmonics& b, double t);

/// Returns the coefficients with bands truncated, or added as zero. Throws `Error` (invalid_argument) unless 1 <= bands
/// <= kMaximumBands.
[[nodiscard]] SphericalHarmonics resized(const SphericalHarmonics& harmonics, int bands);

/// Returns the coefficients of the pointwise product of two functions on the sphere, channel by channel, truncated to
/// `bands` (0: a.bands() + b.bands() - 1, at most kMaximumBands). Exact except for rounding: the product is integrated
/// by a Gauss rule of its own degree.
[[nodiscard]] SphericalHarmonics product(const SphericalHarmonics& a, const SphericalHarmonics& b, int bands = 0);

// ---- Windows: factors that reduce ringing, which makes light from few bands negative

/// Factor of band l. `width` is in bands.
enum class Window {
  none,           ///< 1
  hanning,        ///< (1 + cos(pi l / width)) / 2, 0 from l = width on
  lanczos,        ///< sin(x) / x with x = pi l / width, 0 from l = width on
  min_laplacian,  ///< 1 / (1 + lambda l^2 (l + 1)^2), with the minimum lambda for which no irradiance is negative
};

/// Returns "none", "hanning", "lanczos" or "min-laplacian".
[[nodiscard]] const char* name(Window window) noexcept;

/// The minimum of a function over the sphere and its direction, for each channel.
struct HarmonicMinimum {
  dvec3 value{};         ///< minimum of each channel
  dvec3 direction[3]{};  ///< unit direction of each channel's minimum; any one if several are equal
};

/// Finds the minimum on a grid with 8 points per half wave of the highest band, refined by Newton steps. Error of a
/// value: below 1e-12 of the largest coefficient. A channel with a coefficient that is not finite has the minimum NaN.
/// Cost: 50 us for three bands, milliseconds for 16; ten times as much where the minimum is a ring, as around a single
/// light.
[[nodiscard]] HarmonicMinimum minimum(const SphericalHarmonics& harmonics);

/// Windowed coefficients, and the effect of the window.
struct WindowResult {
  SphericalHarmonics radiance;  ///< windowed coefficients
  double parameter = 0.0;       ///< hanning, lanczos: width in bands; min_laplacian: lambda, 0 if no window was needed
  dvec3 minimum_before{};       ///< minimum of the irradiance over all normals
  dvec3 minimum_after{};        ///< minimum of the windowed irradiance over all normals
  std::vector<double> factors;  ///< factor of each band
};

/// Multiplies each band of radiance by the window's factor. `width` is in bands, for Hanning and Lanczos only; 0
/// selects the number of bands. Band 0, and therefore the mean radiance, never changes.
///
/// `min_laplacian` (Sloan 2008, "Stupid Spherical Harmonics Tricks", and 2017, "Deringing Spherical Harmonics"; the
/// window of minimum squared Laplacian) uses the smallest lambda for which no channel's irradiance is below -1e-9 of
/// its mean anywhere. All channels share one lambda, which preserves colour balance. It is 0 if nothing is negative,
/// and does not depend on the orientation of the light.
///
/// Throws `Error` (invalid_argument) for a width that is negative or not finite. `min_laplacian` also throws it if a
/// coefficient is not finite, or if a channel has negative irradiance although its band 0 is not positive, since no
/// window helps then.
[[nodiscard]] WindowResult apply_window(const SphericalHarmonics& radiance, Window window, double width = 0.0);

// ---- Extracting directional lights from environments

/// The directional light that best approximates an environment of at least two bands.
struct DominantLight {
  dvec3 direction{};   ///< unit vector towards the light
  dvec3 irradiance{};  ///< irradiance on a surface that faces it
};

/// Returns the dominant directional light (after Sloan 2008, "Stupid Spherical Harmonics Tricks", section "Extracting a
/// directional light"). Its direction is that of the linear band's luminance (0.2126, 0.7152, 0.0722), the mean
/// direction of the light. Its colour is, by channel, the least-squares fit of a directional light's coefficients to
/// bands 1 and 2, clamped to 0. Band 0 contains the ambient light and bands above the third are ignored. A uniform
/// environment plus a directional light is recovered exactly.
///
/// Returns nothing if the linear band has no direction: with one band, if its luminance is not finite, or if it is
/// below 1e-6 of band 0's (rounding of a projection leaves 1e-7).
[[nodiscard]] std::optional<DominantLight> dominant_light(const SphericalHarmonics& radiance);

/// Criteria for a sun: a spot that is far brighter than the map, small, and holds a considerable fraction of the map's
/// light. All three must be met. The defaults were chosen on photographs (docs/notes/measurements.md), in which suns
/// have a radius of 0.3 to 1.8 degrees and 2 to 77 % of the light, and lamps, windows and clouds fail by size or
/// fraction. A spotlight as small and strong as a sun is accepted as one.
struct SunOptions {
  /// Luminance, relative to the brightest texel, from which connected texels belong to the spot; above 0 to 1. Fainter
  /// glow stays in the map. A clipped sun in front of bright clouds needs a larger value, such as 0.5.
  double relative_threshold = 0.02;

  /// Maximum distance of the spot's texels from the centre of its light, 0 to 90 degrees. Larger spots are not suns.
  /// Neighbours of the brightest texel are always accepted, however coarse the map.
  double maximum_radius_degrees = 3.0;

  /// Minimum of the brightest luminance relative to the map's mean; at least 1. It decides in coarse maps, where single
  /// texels are large: a map of fewer than 20 texels never has a sun.
  double minimum_contrast = 20.0;

  /// Minimum fraction of the map's luminance in the spot, 0 to 1. Unlike contrast, it does not depend on the
  /// resolution.
  double minimum_share = 0.01;
};

/// A sun extracted from an environment.
struct Sun {
  dvec3 direction{};         ///< unit vector towards the centre of its light: mean over its texels' areas, by luminance
  dvec3 irradiance{};        ///< irradiance of the directional light: integral of the radiance that was removed
  dvec3 radiance{};          ///< mean radiance: irradiance / solid angle
  double solid_angle = 0.0;  ///< solid angle of the spot's texels, steradians
  double angular_radius_degrees = 0.0;  ///< radius of a disc with that solid angle
  std::uint64_t texels = 0;             ///< texels that were changed, of the spot and of its rim
  dvec3 total_radiance_before{};        ///< integral over the sphere
  dvec3 total_radiance_after{};         ///< integral without the sun; before = after + irradiance, to 1e-6
};

/// Extracts the sun from an image in place. The spot's texels, and those touching it, are replaced by the radiance
/// around them: the median, channel by channel, of the next two rings of texels. Texels darker than that are kept.
/// Returns nothing, and changes nothing, if there is no sun by the options. If there are several, the brightest is
/// extracted; another call extracts the next. `image` has RGB floats in Welkin's axes.
///
/// An engine adds the sun back as a directional light with `irradiance` on a surface facing it, which restores the
/// map's total radiance. A real disc of angular radius a has (1 + cos a) / 2 of that irradiance: 2e-5 less for half a
/// degree, 7e-4 for three. Band l of a spot with mean squared radius r^2 (radians) is smaller than the light's by the
/// factor 1 - l(l+1) r^2 / 4; a disc of half a degree loses 6e-5 in band 2.
///
/// A texel with a NaN or infinite channel is ignored and not changed. Replace infinities of a sun that overflowed half
/// floats (65504) first. Negative values are kept. Cost: one pass over the map, and another over the part with the
/// spot; one bit of memory per texel. Throws `Error` (invalid_argument) for options out of range and for pixels that do
/// not match the size.
[[nodiscard]] std::optional<Sun> extract_sun(LatLongImage& image, const SunOptions& options = {});
[[nodiscard]] std::optional<Sun> extract_sun(Cubemap& image, const SunOptions& options = {});

/// Returns the coefficients of a sun's light, to be added to those of its map: a uniform disc with its solid angle and
/// irradiance, in closed form, or a directional light if the solid angle is 0. `radiance`, `angular_radius_degrees` and
/// the total radiances are ignored. Relative error below 1e-13 from a point to the whole sphere. Throws `Error`
/// (invalid_argument) for a direction of length 0, a solid angle outside 0 to 4 pi, or an invalid number of bands.
[[nodiscard]] SphericalHarmonics sun_harmonics(const Sun& sun, int bands);

// ---- Exposure: a factor for radiance before a tone curve
//
//   const double exposure = welkin::exposure_of(projection.radiance);
//   colour = tone_map(exposure * radiance);
//
// Environments have the units of their files: W/(m2 sr nm) for a computed sky, "1 is white" for a photograph.

/// Returns the exposure that scales the mean radiance to middle grey: 0.18 divided by its luminance (Rec. 709). Reads
/// band 0 of radiance coefficients only. Returns 1 if the mean is not above 0, or if the result is not a finite double.
[[nodiscard]] double exposure_of(const SphericalHarmonics& radiance);

/// Returns the exposure that `welkin bake` uses for previews: it scales the 75th percentile of the lit texels'
/// luminance, weighted by solid angle, to 0.36, one stop above middle grey. A texel is lit if it has at least 1/32 of
/// the mean luminance, where values above the 99th percentile are clamped to it. Black around studio lamps, or a sun,
/// has no effect. NaN and values below 0 count as black. Returns 1 if there is no light. Sorts the texels, with 16
/// bytes of memory per texel; a mip of 32 texels per edge gives nearly the same result. Throws `Error`
/// (invalid_argument) for an invalid view.
[[nodiscard]] double exposure_of(const EnvironmentView& image);

}  // namespace welkin
