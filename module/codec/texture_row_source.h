// KTX2 and DDS cubemaps as rows.
#pragma once

#include <memory>

#include "codec/byte_file.h"
#include "codec/row_source.h"

namespace welkin::codec {

/// A file that `is_texture`. Its six faces are those of `CubemapView` and come as a vertical strip. Packed levels are
/// unpacked whole. 8-bit texels are linear or sRGB as the format says, or as ReadOptions.transfer has it. Throws as
/// `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_texture(ByteFile& file, const ReadOptions& options);

}  // namespace welkin::codec
