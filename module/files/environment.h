// Reading a source whole.
#pragma once

#include "files/layout.h"
#include "files/row_source.h"
#include "welkin/control.h"

namespace welkin::files {

/// Where a cube's faces lie in the picture. Throws `Error` (invalid_argument) for a lat-long.
[[nodiscard]] const CubePlacement& placement_in(const RowSource& source);

/// Decodes all rows of a source, several groups at a time; the faces of a cube, whatever its layout, go each to its
/// own place. What lies beside them in a cross is decoded and not kept. Throws `Error`: limit_exceeded before
/// anything is read, cancelled, and whatever reading throws.
[[nodiscard]] Environment read_whole(const RowSource& source, const ReadOptions& options, const Control& control);

}  // namespace welkin::files
