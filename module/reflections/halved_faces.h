// Faces of a cubemap with half as many texels along an edge and, to lobes much wider than those, the same light.
#pragma once

#include <cstddef>
#include <vector>

#include "reflections/source_rows.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Texels along an edge of faces that can be halved.
[[nodiscard]] constexpr bool can_be_halved(int size) noexcept { return size % 16 == 0 && size > 0; }

/// Returns faces halved until they have `size` texels along an edge: theirs divided by a power of two, at least 8
/// unless it is theirs. Each texel's light goes to 4 x 4 of its own face (3 at an edge) with its moments up to the
/// third (the second), so degree l loses a share that is proportional to (l h)^4, h the new texel's size. Uniform light
/// stays uniform. Results can be negative next to bright texels. The same bits on any number of threads and instruction
/// set. Throws `Error` (cancelled).
[[nodiscard]] SourceRows halved_faces(SourceRows faces, int size, const Control& control);

/// Returns a bound on what that takes, its tables and the result included.
[[nodiscard]] std::size_t halved_faces_bytes(int from, int size) noexcept;

}  // namespace welkin::reflections
