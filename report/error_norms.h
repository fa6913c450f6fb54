// How far a result is from the truth, in the two numbers that a report has.
#pragma once

#include <span>

#include "welkin/spherical_harmonics.h"

namespace welkin::report {

struct ErrorNorms {
  double rms = 0.0;      ///< relative: 0.01 is 1 %
  double maximum = 0.0;  ///< likewise
};

/// |c - c*| / |c*| over all coefficients and channels: the relative rms error of the function on the sphere.
/// `found` has at least as many bands as `truth`; what it has beyond is not looked at.
[[nodiscard]] double relative_error(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// |c - c*| / |c*| of the worst channel.
[[nodiscard]] double worst_channel_error(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// rms: `relative_error` of the coefficients of radiance. Maximum: the largest difference of the irradiance over 256
/// normals, over the root mean square of the true irradiance; differences are lengths over the three channels.
[[nodiscard]] ErrorNorms harmonic_errors(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// Root mean square over all normals of the irradiance, as the length over three channels, that this radiance gives.
[[nodiscard]] double rms_of_irradiance(const SphericalHarmonics& radiance);

/// Several cases as one: the root mean square of their rms errors, and the largest maximum.
[[nodiscard]] ErrorNorms together(std::span<const ErrorNorms> cases);

}  // namespace welkin::report
