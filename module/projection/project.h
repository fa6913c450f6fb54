// How far off a projection probably is.
#pragma once

#include <cstddef>
#include <span>

#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::projection {

/// What a projection did that costs accuracy; 0: did not.
struct ErrorSources {
  double midpoint_size = 0.0;  ///< edge of the face that the midpoint rule was applied to
  double reduced_size = 0.0;   ///< edge of the face that the source was averaged to
};

/// Estimated relative error |c - c*| / |c*|.
///
/// Rounding: 2e-7. Midpoint rule: band l is off by up to 0.14 l^2 / N^2 of itself (measured: 0.64 % of band 2
/// at N = 8). Averaging over cells of angle d = pi/2 / N: smooth content loses l (l + 1) d^2 / 24 of band l;
/// light from a point lands up to half a cell away, which moves band l by l d / 4 of what a point puts
/// there. How much of the light is a point's is told from band 2: a point has |c_2|^2 = 5 |c_0|^2, a smooth
/// sky far less. Meant to be right within a factor of a few, and rather too large than too small.
[[nodiscard]] double estimate_error(const SphericalHarmonics& radiance, const ErrorSources& sources);

// Which size of an environment a projection reads.

/// The target face size as the quadrature understands it for a face of `size` texels (Babylon.js rounds down to a
/// power of two, and so does the midpoint rule); 0 if there is none or the source is no larger.
[[nodiscard]] int effective_target(int size, const ProjectionOptions& options) noexcept;

/// The level nearest to `target` in log2: the index of one of `sizes`, which fall.
[[nodiscard]] std::size_t nearest_level(std::span<const int> sizes, int target) noexcept;

}  // namespace welkin::projection
