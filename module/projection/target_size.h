// Which size of an environment a projection reads.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "welkin/projection.h"

namespace welkin::projection {

/// The target face size as the quadrature understands it for a face of `size` texels (Babylon.js rounds down to a
/// power of two, and so does the midpoint rule); none if there is none or the source is no larger.
[[nodiscard]] std::optional<int> effective_target(int size, const ProjectionOptions& options) noexcept;

/// The level nearest to `target` in log2: the index of one of `sizes`, which fall.
[[nodiscard]] std::size_t nearest_level(std::span<const int> sizes, int target) noexcept;

}  // namespace welkin::projection
