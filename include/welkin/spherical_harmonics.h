// Real spherical harmonics: coefficients, their basis, and what is done to coefficients after a projection.
//
//   welkin::SphericalHarmonics irradiance = welkin::irradiance_from_radiance(light.radiance);
//   welkin::dvec3 ground = welkin::evaluate(irradiance, {0.0, 1.0, 0.0});   // W/m2 on a surface that faces up
//
// Convention, everywhere in Welkin: orthonormal real harmonics without Condon-Shortley phase, coefficient
// (l, m) at index l (l + 1) + m, Y(1, -1..1) proportional to y, z, x. Other engines' signs, orders and
// scales are adapters (see engines.h).
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "welkin/core.h"

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

}  // namespace welkin
