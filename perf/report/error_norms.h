// How far a result is from the truth, in the two numbers that a report has.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <random>
#include <span>
#include <vector>

#include "welkin/image.h"
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

/// Of each value the difference over the given one, as far as halves hold that, or over 2^-14 where it is less: root
/// mean square and largest. Both have the same length.
[[nodiscard]] ErrorNorms relative_errors(std::span<const float> found, std::span<const float> given);

/// Several cases as one: the root mean square of their rms errors, and the largest maximum.
[[nodiscard]] ErrorNorms together(std::span<const ErrorNorms> cases);

/// A texel of a level, counted over faces, rows, columns.
struct Probe {
  std::int64_t texel = 0;
  double weight = 0.0;  ///< of its square in the rms: in proportion to the solid angle that it stands for
};

/// All texels of a level, or one of each of `count` equal runs and beside them the eight brightest and darkest, which
/// have no weight in the rms.
[[nodiscard]] std::vector<Probe> probes_of(const Cubemap& chain, int level, int count, std::mt19937& random);

/// Unit directions of the probes' centres on a level of `size` texels an edge.
[[nodiscard]] std::vector<glm::dvec3> directions_of(const std::vector<Probe>& probes, int size);

struct ProbeErrors {
  ErrorNorms norms;          ///< rms by solid angle over that of the truth; largest |value - truth| / truth
  double truth_there = 0.0;  ///< at the largest: truth over the mean
};

/// `truth` and `mean`: at the probes, and of the whole. Truth below a millionth of the mean counts as that much: what
/// is black is not measured against 0.
[[nodiscard]] ProbeErrors errors_at(const Cubemap& chain, int level, const std::vector<Probe>& probes,
                                    const std::vector<glm::dvec3>& truth, const glm::dvec3& mean);

}  // namespace welkin::report
