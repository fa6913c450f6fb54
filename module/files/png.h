// PNG files as rows.
#pragma once

#include <memory>

#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

/// `file` starts with a PNG's signature. Every colour type and depth is read; alpha is ignored, colours are taken as
/// they are (PNG's are not premultiplied); colours beyond the end of a palette are black.
///
/// Samples are made linear by sRGB's curve unless ReadOptions.transfer says linear, or says nothing and the file has
/// a gAMA chunk of 1 and no sRGB chunk. Other gAMA values are not applied: nearly all are an approximation of sRGB.
/// With a cHRM chunk and no sRGB chunk, colours become Rec. 709 unless they are wanted as stored. ICC profiles and
/// cICP chunks are not applied. What was decided is in the notes.
///
/// A PNG is one stream: rows come one after the other from the top, and a reader that is asked for a row above the
/// last one starts again. An interlaced one is decoded whole at its first row: 3 or 8 bytes a texel.
/// Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_png(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
