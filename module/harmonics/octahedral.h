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

/// Returns the bytes that making it holds at most beside it, from a cubemap whose level 0 has `cube_size` texels along
/// an edge.
[[nodiscard]] std::uint64_t working_bytes(const OctahedralOptions& options, int cube_size,
                                          std::size_t workers) noexcept;

}  // namespace welkin::octahedral
