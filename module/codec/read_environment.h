// Reading a source whole.
#pragma once

#include "codec/row_source.h"
#include "welkin/control.h"

namespace welkin::codec {

/// Decodes all rows of a source, several groups at a time. Throws `Error`: limit_exceeded before anything
/// is read, cancelled, and whatever reading throws.
[[nodiscard]] Environment read_whole(const RowSource& source, const ReadOptions& options, const Control& control);

}  // namespace welkin::codec
