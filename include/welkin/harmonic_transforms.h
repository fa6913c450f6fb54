// Turning and combining spherical harmonics. Everything here is in double precision and takes any number of bands.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "welkin/export.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Coefficients of the light after it was turned: what came from direction d comes from rotation * d.
/// Band by band by the recurrence of Ivanic and Ruedenberg (1996, with the 1998 corrections); error below 1e-13 for
/// 16 bands; 10 000 steps in a row stay within 1e-11, and so does each band's power. The quaternion is normalised
/// first. Cost: a microsecond for three bands, some 100 for 16. Throws `Error` (invalid_argument) for a quaternion
/// without length.
[[nodiscard]] SphericalHarmonics rotate(const SphericalHarmonics& harmonics, const glm::dquat& rotation);

/// The same for an orthogonal matrix, mirrors included. Throws `Error` (invalid_argument) if it is off orthogonal by
/// more than 1e-6; the nearest orthogonal matrix is what is applied.
[[nodiscard]] SphericalHarmonics transform(const SphericalHarmonics& harmonics, const glm::dmat3& orthogonal);

/// a + b and factor * a (per channel); of two band counts the larger, missing bands being zero.
[[nodiscard]] SphericalHarmonics add(const SphericalHarmonics& a, const SphericalHarmonics& b);
[[nodiscard]] SphericalHarmonics scale(const SphericalHarmonics& a, const glm::dvec3& factor);

/// (1 - t) a + t b; t is not clamped.
[[nodiscard]] SphericalHarmonics lerp(const SphericalHarmonics& a, const SphericalHarmonics& b, double t);

/// Bands cut off, or added as zero. Throws `Error` (invalid_argument) unless 1 <= bands <= kMaximumBands.
[[nodiscard]] SphericalHarmonics with_bands(const SphericalHarmonics& harmonics, int bands);

/// Coefficients of the pointwise product of two functions on the sphere, channel by channel, cut off at `bands`
/// (0: all of them, a.bands() + b.bands() - 1, at most kMaximumBands). Exact but for rounding: the product's
/// band limit is known, and it is integrated by a Gauss rule of that degree.
[[nodiscard]] SphericalHarmonics product(const SphericalHarmonics& a, const SphericalHarmonics& b, int bands = 0);

}  // namespace welkin
