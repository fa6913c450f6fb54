// Real spherical harmonics: coefficients, basis, and what is done to them after a projection.
//
// Convention, everywhere in Welkin: orthonormal real harmonics without Condon-Shortley phase, coefficient
// (l, m) at index l (l + 1) + m, Y(1, -1..1) proportional to y, z, x. Other engines' signs, orders and
// scales are adapters (see babylon.h).
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// The most bands that any call takes. Band l = bands - 1 is the highest one present.
inline constexpr int kMaximumBands = 16;

/// RGB coefficients of `bands` bands: bands^2 triples, all zero at first.
/// Whether they are radiance or irradiance is said by whoever hands them out.
class SphericalHarmonics {
 public:
  /// One band.
  SphericalHarmonics() : SphericalHarmonics(1) {}

  /// Throws `Error` (invalid_argument) unless 1 <= bands <= kMaximumBands.
  explicit SphericalHarmonics(int bands);

  /// Number of bands; there are bands x bands coefficients.
  [[nodiscard]] int bands() const noexcept { return bands_; }

  /// Coefficient of band l >= 0 and order -l <= m <= l; both are the caller's to keep in range.
  [[nodiscard]] const glm::dvec3& at(int l, int m) const { return values_[index(l, m)]; }
  /// The same, to be written.
  [[nodiscard]] glm::dvec3& at(int l, int m) { return values_[index(l, m)]; }

  /// All of them, in the order of `index`.
  [[nodiscard]] std::span<const glm::dvec3> coefficients() const noexcept { return values_; }
  /// The same, to be written.
  [[nodiscard]] std::span<glm::dvec3> coefficients() noexcept { return values_; }

  /// Where coefficient (l, m) stands: l (l + 1) + m.
  [[nodiscard]] static constexpr std::size_t index(int l, int m) noexcept {
    return static_cast<std::size_t>(l * (l + 1) + m);
  }

 private:
  int bands_;
  std::vector<glm::dvec3> values_;
};

/// Writes Y(l, m) of a unit direction for all l < bands to `values` (bands^2 of them).
/// Error below 5e-14 (5e-15 up to 8 bands), that of a rounded unit direction included. Cost: about 3 flops a value.
/// Throws `Error` (invalid_argument) on a wrong band count or too short a span.
void evaluate_basis(const glm::dvec3& direction, int bands, std::span<double> values);

/// Sum over all coefficients times their basis functions at a unit direction: the radiance from there, or
/// the irradiance on a surface that faces there, whichever the coefficients are of.
[[nodiscard]] glm::dvec3 evaluate(const SphericalHarmonics& coefficients, const glm::dvec3& direction);

/// A_l, the cosine lobe's factor for band l: pi, 2 pi/3, pi/4, 0, -pi/24, 0, pi/64, ...
/// (Ramamoorthi and Hanrahan 2001, equations 8 and 9; odd bands above 1 are zero.) `l` >= 0.
[[nodiscard]] double cosine_lobe(int l);

/// Radiance coefficients to irradiance: band l times A_l. W/m2 where radiance was W/m2/sr.
[[nodiscard]] SphericalHarmonics irradiance_from_radiance(const SphericalHarmonics& radiance);

/// Irradiance to what a white Lambertian surface reflects: times 1/pi.
[[nodiscard]] SphericalHarmonics lambertian_from_irradiance(const SphericalHarmonics& irradiance);

/// Coefficients of a sphere with the same radiance everywhere: band 0 alone.
[[nodiscard]] SphericalHarmonics constant_radiance(const glm::dvec3& radiance, int bands = 1);

/// The sphere's mean radiance: what a scene with a single ambient colour needs, c(0,0) / sqrt(4 pi).
[[nodiscard]] glm::dvec3 average_radiance(const SphericalHarmonics& radiance);

}  // namespace welkin
