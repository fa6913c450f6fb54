// How far the coefficients of a projection are from those of the image.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "welkin/projection.h"

namespace welkin::projection {

/// Returns the relative error |c - c*| / |c*| of coefficients c, rounding of sums included. `exact`: c* as known from
/// the pixels read, to within `beyond`. (midpoint_error.h, `FaceSums::exact`, `LatLongProjector`)
[[nodiscard]] double relative_error(std::span<const glm::dvec3> radiance, std::span<const glm::dvec3> exact,
                                    double beyond = 0.0);

/// Returns a guess of the relative error of a mip's coefficients against those of its chain's first mip, which is not
/// read. `size`: texels along a face's edge. Smooth content loses up to l (l + 1) d^2 / 7 of band l, d = pi/2 / size (a
/// cell blurs twice, when it is averaged and when it is read as an area). Light from a point lands up to half a cell
/// away, which moves band l by up to 0.35 l d of what a point puts there. The point's part of the light follows from
/// band 2: a point has |c_2|^2 = 5 |c_0|^2, a smooth sky far less. Detail beyond the bands moves light by a share of
/// size^-2, unless the image is nearly uniform. The guess misses a pattern that the mip averages away.
[[nodiscard]] double mip_error(std::span<const glm::dvec3> radiance, double size);

// Which size of an environment a projection reads.

/// The target face size as the quadrature understands it for a face of `size` texels (Babylon.js rounds down to a
/// power of two, and so does the midpoint rule); none if there is none or the source is no larger.
[[nodiscard]] std::optional<int> effective_target(int size, const ProjectionOptions& options) noexcept;

/// The level nearest to `target` in log2: the index of one of `sizes`, which fall.
[[nodiscard]] std::size_t nearest_level(std::span<const int> sizes, int target) noexcept;

}  // namespace welkin::projection
