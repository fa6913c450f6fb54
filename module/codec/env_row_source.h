// Babylon.js .env files as rows.
#pragma once

#include <memory>

#include "codec/byte_file.h"
#include "codec/row_source.h"

namespace welkin::codec {

/// A file that `is_env`. Faces come in Welkin's axes (x mirrored: Babylon.js's are left-handed) as a vertical strip;
/// each decodes whole. Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_env(ByteFile& file, const ReadOptions& options);

}  // namespace welkin::codec
