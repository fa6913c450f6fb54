// Real spherical harmonics: coefficients, their basis, and what is done to coefficients after a projection.
//
//   welkin::SphericalHarmonics irradiance = welkin::irradiance_from_radiance(light.radiance);
//   welkin::dvec3 ground = welkin::evaluate(irradiance, {0.0, 1.0, 0.0});   // W/m2 on a surface that faces up
//
// Convention, everywhere in Welkin: orthonormal real harmonics without Condon-Shortley phase, coefficient
// (l, m) at index l (l + 1) + m, Y(1, -1..1) proportional to y, z, x. Other engines' signs, orders and
// scales are adapters (see engines.h).
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

/// The largest number of bands that any call takes. Band l = bands - 1 is the highest one present.
inline constexpr int kMaximumBands = 16;

/// RGB coefficients of `bands` bands: bands^2 triples, all zero at first.
/// The call that returns them says whether they are radiance or irradiance.
class SphericalHarmonics {
 public:
  /// One band.
  SphericalHarmonics() : SphericalHarmonics(1) {}

  /// Throws `Error` (invalid_argument) unless 1 <= bands <= kMaximumBands.
  explicit SphericalHarmonics(int bands);

  /// Number of bands; there are bands x bands coefficients.
  [[nodiscard]] int bands() const noexcept { return bands_; }

  /// Coefficient of band l >= 0 and order -l <= m <= l; both are the caller's to keep in range.
  [[nodiscard]] const dvec3& at(int l, int m) const { return values_[index(l, m)]; }
  /// The same, to be written.
  [[nodiscard]] dvec3& at(int l, int m) { return values_[index(l, m)]; }

  /// All of them, in the order of `index`.
  [[nodiscard]] std::span<const dvec3> coefficients() const noexcept { return values_; }
  /// The same, to be written.
  [[nodiscard]] std::span<dvec3> coefficients() noexcept { return values_; }

  /// Where coefficient (l, m) stands: l (l + 1) + m.
  [[nodiscard]] static constexpr std::size_t index(int l, int m) noexcept {
    return static_cast<std::size_t>(l * (l + 1) + m);
  }

 private:
  int bands_;
  std::vector<dvec3> values_;
};

/// Writes Y(l, m) of a direction for all l < bands to `values` (bands^2 of them).
/// Error below 5e-14 (5e-15 up to 8 bands), that of a rounded unit direction included. Cost: about 3 flops a value.
/// Throws `Error` (invalid_argument) on a wrong band count, direction or too short a span.
void evaluate_basis(const dvec3& direction, int bands, std::span<double> values);

/// Returns the sum over all coefficients times their basis functions at a direction: the radiance from there, or the
/// irradiance on a surface that faces there, whichever the coefficients are of. Throws `Error` (invalid_argument).
[[nodiscard]] dvec3 evaluate(const SphericalHarmonics& coefficients, const dvec3& direction);

/// A_l, the cosine lobe's factor for band l: pi, 2 pi/3, pi/4, 0, -pi/24, 0, pi/64, ...
/// (Ramamoorthi and Hanrahan 2001, equations 8 and 9; odd bands above 1 are zero.) `l` >= 0.
[[nodiscard]] double cosine_lobe(int l);

/// Radiance coefficients to irradiance: band l times A_l. W/m2 where radiance was W/m2/sr.
[[nodiscard]] SphericalHarmonics irradiance_from_radiance(const SphericalHarmonics& radiance);

/// Irradiance to what a white Lambertian surface reflects: times 1/pi.
[[nodiscard]] SphericalHarmonics lambertian_from_irradiance(const SphericalHarmonics& irradiance);

/// Coefficients of a sphere with the same radiance everywhere: band 0 alone.
[[nodiscard]] SphericalHarmonics constant_radiance(const dvec3& radiance, int bands = 1);

/// The sphere's mean radiance: what a scene with a single ambient colour needs, c(0,0) / sqrt(4 pi).
[[nodiscard]] dvec3 mean_radiance(const SphericalHarmonics& radiance);

// ---- Turning and combining: in double precision, for any number of bands

/// A rotation as a quaternion of any length but 0. (The members of GLM's quaternions lie in another order under
/// GLM_FORCE_QUAT_DATA_WXYZ, so none of them is handed to the library.)
struct Quaternion {
  double w = 1.0;  ///< cosine of half the angle
  double x = 0.0;  ///< sine of half the angle times the axis
  double y = 0.0;  ///< likewise
  double z = 0.0;  ///< likewise
};

/// Coefficients of the light after it was turned: what came from direction d comes from turn * d.
/// Band by band by the recurrence of Ivanic and Ruedenberg (1996, with the 1998 corrections); error below 1e-13 for
/// 16 bands; 10 000 steps in a row stay within 1e-11, and so does each band's power. The quaternion is normalised
/// first. Cost: a microsecond for three bands, some 100 for 16. Throws `Error` (invalid_argument) for a quaternion
/// without length.
[[nodiscard]] SphericalHarmonics turned(const SphericalHarmonics& harmonics, const Quaternion& turn);
/// The same for a quaternion of GLM's: `turned(harmonics, glm::angleAxis(angle, axis))`.
template <glm::qualifier Precision>
[[nodiscard]] SphericalHarmonics turned(const SphericalHarmonics& harmonics, const glm::qua<double, Precision>& turn) {
  return turned(harmonics, Quaternion{.w = turn.w, .x = turn.x, .y = turn.y, .z = turn.z});
}

/// The same for an orthogonal matrix, mirrors included. Throws `Error` (invalid_argument) if it is off orthogonal by
/// more than 1e-6; the nearest orthogonal matrix is what is applied.
[[nodiscard]] SphericalHarmonics turned(const SphericalHarmonics& harmonics, const dmat3& turn);

/// a + b, with as many bands as the larger one has; missing bands are zero.
[[nodiscard]] SphericalHarmonics add(const SphericalHarmonics& a, const SphericalHarmonics& b);
/// factor * a, channel by channel.
[[nodiscard]] SphericalHarmonics scale(const SphericalHarmonics& a, const dvec3& factor);

/// (1 - t) a + t b; t is not clamped.
[[nodiscard]] SphericalHarmonics lerp(const SphericalHarmonics& a, const SphericalHarmonics& b, double t);

/// Bands cut off, or added as zero. Throws `Error` (invalid_argument) unless 1 <= bands <= kMaximumBands.
[[nodiscard]] SphericalHarmonics with_bands(const SphericalHarmonics& harmonics, int bands);

/// Coefficients of the pointwise product of two functions on the sphere, channel by channel, cut off at `bands`
/// (0: all of them, a.bands() + b.bands() - 1, at most kMaximumBands). Exact but for rounding: the product's
/// band limit is known, and it is integrated by a Gauss rule of that degree.
[[nodiscard]] SphericalHarmonics product(const SphericalHarmonics& a, const SphericalHarmonics& b, int bands = 0);

// ---- Windows against ringing (where a few bands make light negative)

/// By what band l is multiplied. `width` is in bands.
enum class Window {
  none,           ///< 1
  hanning,        ///< (1 + cos(pi l / width)) / 2, 0 from l = width on
  lanczos,        ///< sin(x) / x with x = pi l / width, 0 from l = width on
  min_laplacian,  ///< 1 / (1 + lambda l^2 (l + 1)^2), with the smallest lambda that leaves no irradiance negative
};

/// "none", "hanning", "lanczos", "min-laplacian"
[[nodiscard]] const char* name(Window window) noexcept;

/// The minimum of a function over the sphere, by channel, and where it is.
struct HarmonicMinimum {
  dvec3 value{};         ///< of each channel at its own direction
  dvec3 direction[3]{};  ///< unit, by channel; one of them where several are equal
};

/// Finds the minimum on a grid finer than the highest band (8 points to each half wave of it), refined by Newton
/// steps. Error of a value: below 1e-12 of the largest coefficient. The same bits everywhere. A channel with a
/// coefficient that is not finite has the minimum NaN. Cost: some 50 microseconds for three bands, some milliseconds
/// for 16; ten times as much where the minimum is a ring, as around a lone light.
[[nodiscard]] HarmonicMinimum minimum(const SphericalHarmonics& harmonics);

/// Windowed coefficients, and what the window did.
struct Windowed {
  SphericalHarmonics radiance;  ///< the windowed coefficients
  double parameter = 0.0;  ///< hanning, lanczos: the width in bands; min_laplacian: lambda (0 if nothing was needed)
  dvec3 minimum_before{};  ///< of the irradiance over all normals
  dvec3 minimum_after{};   ///< the same of the windowed irradiance
  std::vector<double> factors;  ///< by band
};

/// Multiplies each band of radiance by the window's factor. `width`: of Hanning and Lanczos in bands, 0: the number of
/// bands; the others take no notice of it. Band 0 and so the mean radiance never change.
///
/// `min_laplacian` (Sloan 2008, "Stupid Spherical Harmonics Tricks", and 2017, "Deringing Spherical Harmonics"; the
/// window of minimum squared Laplacian): no channel's irradiance is below -1e-9 of its mean anywhere, and with any
/// smaller lambda some channel's would be (but for that tolerance). One lambda for all channels, so that colours keep
/// their balance. It is 0 if nothing is negative. It does not depend on how the light is turned.
///
/// Throws `Error` (invalid_argument) for a width that is negative or not finite; for `min_laplacian`, if a coefficient
/// is not finite, or if a channel's band 0 is not positive although some of the channel's irradiance is negative: no
/// window helps there.
[[nodiscard]] Windowed apply_window(const SphericalHarmonics& radiance, Window window, double width = 0.0);

// ---- Light with a direction: what in an environment is best given to a directional light

/// The one directional light that comes closest to an environment of two bands or more.
struct DominantLight {
  dvec3 direction{};   ///< unit, towards the light
  dvec3 irradiance{};  ///< on a surface that faces it
};

/// Direction: that of the linear band's luminance (0.2126, 0.7152, 0.0722), the mean direction of the light. Colour, by
/// channel: the least-squares fit of a directional light's coefficients from there to bands 1 and 2 (band 0 has the
/// ambient light in it; bands above the third are left out, so that it does not matter how many there are), not below
/// zero (after Sloan 2008, "Stupid Spherical Harmonics Tricks", section "Extracting a directional light"). A constant
/// and a directional light come back exactly. None if the linear band has no direction: if its luminance is below
/// 1e-6 of band 0's (a projection's rounding leaves 1e-7), not finite, or there is one band only.
[[nodiscard]] std::optional<DominantLight> dominant_light(const SphericalHarmonics& radiance);

/// What counts as a sun: a spot that is far brighter than the map, small, and a good part of the map's light. All
/// three are needed; the defaults are chosen on photographs (docs/notes/measurements.md), where suns are 0.3 to 1.8
/// degrees in radius and 2 to 77 % of the light, and lamps, windows and clouds fail by size or by share. A spotlight
/// that is as small and strong as a sun is taken for one: nothing in a map tells them apart.
struct SunOptions {
  /// Texels of at least this share of the brightest one's luminance that are joined to it are the spot; above 0 to 1.
  /// What is fainter, the glow, stays in the map. A clipped sun before bright clouds wants more, 0.5 perhaps.
  double relative_threshold = 0.02;

  /// If one of them lies farther than this from the centre of the spot's light, 0 to 90 degrees, the spot is too large
  /// for a light without extent, and there is no sun. Neighbours of the brightest texel count as near, however coarse
  /// the map is.
  double maximum_radius_degrees = 3.0;

  /// There is no sun if the brightest luminance is less than this times the map's mean; at least 1. It matters in
  /// coarse maps, where a neighbourhood is no longer small: below some 20 texels no map has a sun.
  double minimum_contrast = 20.0;

  /// There is no sun if the spot has less than this share of the map's luminance, 0 to 1: taking it out would help
  /// nobody. (Unlike contrast the share does not depend on the map's resolution.)
  double minimum_share = 0.01;
};

/// A sun that was taken out of an environment.
struct Sun {
  dvec3 direction{};         ///< unit, towards the centre of its light: mean over its texels' areas, by luminance
  dvec3 irradiance{};        ///< of the directional light: what was taken out, integral of (L - what was left) dw
  dvec3 radiance{};          ///< its mean: irradiance / solid angle
  double solid_angle = 0.0;  ///< of the texels of the spot, steradians
  double angular_radius_degrees = 0.0;  ///< of a disc with that solid angle
  std::uint64_t texels = 0;             ///< that were changed: of the spot and of its rim
  dvec3 total_radiance_before{};        ///< of the map, integral over the sphere
  dvec3 total_radiance_after{};         ///< of the map without its sun; before = after + irradiance, to 1e-6
};

/// Finds the sun and takes it out, in place: the spot's texels and those that touch it, which its edge covers in part,
/// become the radiance around them, the median channel by channel of the next two rings of texels, unless
/// they were darker. None, and nothing changed, if there is no sun by the options. Of several the brightest is taken;
/// another call takes the next. `pixels` are RGB floats in Welkin's axes.
///
/// An engine adds the sun back as a directional light that makes `irradiance` on a surface which faces it; so the total
/// radiance is the map's again. The sun itself, a disc of angular radius a, makes (1 + cos a) / 2 of that, as not all
/// of it is straight ahead: 2e-5 less for half a degree, 7e-4 for three. In bands: band l of a spot with mean squared
/// radius r^2 (radians) is smaller than the light's by the factor 1 - l(l+1) r^2 / 4, which for a disc of half a degree
/// takes 6e-5 from band 2.
///
/// A texel with a channel that is NaN or infinite is left alone, is nobody's neighbour, and is in no sum: replace a
/// sun that overflowed (65504 is the largest half) before. Negatives are kept; they are never made brighter.
///
/// Cost: reads the map once, in the arena, and once more its part with the spot; takes a bit of memory a texel.
/// The same bits for any number of threads and on every machine.
/// Throws `Error` (invalid_argument) for options out of range and for pixels that do not fit the size.
[[nodiscard]] std::optional<Sun> take_out_sun(LatLongImage& image, const SunOptions& options = {});
[[nodiscard]] std::optional<Sun> take_out_sun(Cubemap& image, const SunOptions& options = {});

/// The coefficients of a sun's light, to be added to those of its map: a uniform disc of its solid angle that holds its
/// irradiance (radiance times solid angle), in closed form; with solid angle 0 a light from one direction. `radiance`,
/// `angular_radius_degrees` and the total radiances are not read. Relative error below 1e-13 from a point to the whole
/// sphere. Throws `Error` (invalid_argument) for a direction without length, a solid angle outside 0 to 4 pi, or a
/// wrong number of bands.
[[nodiscard]] SphericalHarmonics sun_harmonics(const Sun& sun, int bands);

// ---- Exposure: the factor that radiance is multiplied by before a tone curve
//
//   const double exposure = welkin::exposure_of(projection.radiance);
//   colour = tone_map(exposure * radiance);
//
// Environments come in whatever unit their file has: W/(m2 sr nm) of a computed sky, "1 is white" of a photograph.

/// Returns the exposure that takes the mean radiance to middle grey: 0.18 over its luminance (Rec. 709). Reads band 0
/// of radiance coefficients alone. Returns 1 if the mean is not above 0, or so small or large that no double holds the
/// result.
[[nodiscard]] double exposure_of(const SphericalHarmonics& radiance);

/// Returns the exposure of `welkin bake`'s previews. It takes the 75th percentile of the lit texels' luminance, by
/// solid angle, to 0.36, a stop above middle grey. Lit texels are those of at least 1/32 of the mean, for which
/// luminance above its 99th percentile counts as that percentile: neither the black around a studio's lamps nor a sun
/// changes the result. NaN and values below 0 count as black. Returns 1 if there is no light. Sorts the texels, with 16
/// bytes of memory per texel; a mip of 32 texels per edge gives nearly the same. Throws `Error` (invalid_argument) for
/// a view that is not valid.
[[nodiscard]] double exposure_of(const EnvironmentView& picture);

}  // namespace welkin
