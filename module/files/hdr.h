// Radiance pictures (.hdr, .pic, .rgbe, .xyze) as rows.
#pragma once

#include <memory>

#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

/// `file` stands at its beginning and starts with "#?". See hdr_header.h for what of the header is obeyed,
/// hdr_scanlines.h for the codes and the numbers. XYZE and pictures with PRIMARIES become Rec. 709 unless they are
/// wanted as stored; one without PRIMARIES is taken to be Rec. 709, as by all programs but Radiance itself.
///
/// Rows that are scanlines stream. Where columns are the scanlines, the first read decodes the whole picture, which
/// all readers share: 4 bytes a texel.
/// Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_hdr(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
