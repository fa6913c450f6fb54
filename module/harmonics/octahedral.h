// Octahedral maps from the inside: what a plan knows of one before its cubemap is there.
#pragma once

#include <cstddef>
#include <cstdint>

#include "welkin/resampling.h"

namespace welkin::octahedral {

/// Throws `Error` (invalid_argument) for options out of range, and above so many levels.
void check_options(const OctahedralOptions& options, int most_levels);

/// Returns the bytes of the map.
[[nodiscard]] std::uint64_t map_bytes(const OctahedralOptions& options) noexcept;

/// Returns the most bytes of working memory, without the map, that are needed to make it from a cubemap with
/// `cube_size` texels per edge.
[[nodiscard]] std::uint64_t working_bytes(const OctahedralOptions& options, int cube_size,
                                          std::size_t workers) noexcept;

}  // namespace welkin::octahedral
