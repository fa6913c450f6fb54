// OpenEXR files as rows.
#pragma once

#include <memory>

#include "codec/byte_file.h"
#include "codec/row_source.h"

namespace welkin::codec {

/// `file` stands at its beginning and starts with OpenEXR's magic number. Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_exr(ByteFile& file, const ReadOptions& options);

}  // namespace welkin::codec
