// PFM files as rows.
#pragma once

#include <memory>

#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

/// Opens a PFM as rows. `file` is at its beginning and starts with "PF" (RGB) or "Pf" (grey, which becomes three equal
/// channels). Throws the errors of `inspect_environment`.
///
/// Header: kind, width, height and scale, separated by white space, a single white space after the scale; then rows
/// from bottom to top. The scale's sign is the byte order (negative: little-endian). Its size is ignored, as by nearly
/// all programs: some write 1, others a gain that readers do not apply.
[[nodiscard]] std::unique_ptr<RowSource> open_pfm(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
