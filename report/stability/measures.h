// How far a result is from its truth.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "welkin/cubemap_chain.h"
#include "welkin/error.h"
#include "welkin/image_view.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::report::stability {

/// |c| over all coefficients and channels, from band `first` on.
[[nodiscard]] double norm(const SphericalHarmonics& c, int first_band = 0);

/// |a - truth| over coefficients from band `first_band` on.
[[nodiscard]] double distance(const SphericalHarmonics& a, const SphericalHarmonics& truth, int first_band = 0);

/// distance over norm of the truth. 0 if both are zero.
[[nodiscard]] double relative_error(const SphericalHarmonics& a, const SphericalHarmonics& truth, int first_band = 0);

/// |found - truth| / |truth|; 0 if equal, infinity where the truth alone is 0 or the found value no number.
[[nodiscard]] double relative_error(double found, double truth);
[[nodiscard]] double relative_error(const glm::dvec3& found, const glm::dvec3& truth);

/// Error in units of the last place of the float nearest to the truth (of the largest one, where that is beyond them).
[[nodiscard]] double float_ulps(double found, double truth);

/// Root of the sum of squared differences over that of the squared truths.
[[nodiscard]] double rms_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth);

/// The larger one; infinity as soon as one of them is no number.
[[nodiscard]] double worse(double a, double b) noexcept;

/// 1 where something is wrong.
[[nodiscard]] inline double wrong_if(bool wrong) noexcept { return wrong ? 1.0 : 0.0; }

/// How many of these are negative or not finite.
[[nodiscard]] double unsound(std::span<const float> values) noexcept;

/// 0 if `call` throws an `Error` of that code, else 1.
[[nodiscard]] double wrong_unless_thrown(ErrorCode code, const std::function<void()>& call);

/// Unit directions of all texels' centres of a cubemap, in the order of its memory.
[[nodiscard]] std::vector<glm::dvec3> texel_directions(int size);

/// Evenly over the sphere: a Fibonacci spiral.
[[nodiscard]] std::vector<glm::dvec3> spread_directions(int count);

/// The texels of a level in the order of its memory.
[[nodiscard]] std::vector<glm::dvec3> texels(const CubemapChain& chain, int level);

/// Where the truth is above 0: the largest relative error of any channel.
[[nodiscard]] double worst_relative_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth);

}  // namespace welkin::report::stability
