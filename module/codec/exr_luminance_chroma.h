// OpenEXR pictures of luminance and subsampled chroma, as RGB rows.
#pragma once

#include <cstdint>
#include <memory>

#include "codec/exr_picture.h"
#include "codec/row_source.h"

namespace welkin::codec {

/// A reader of the stored rows (data_width x data_height) as RGB in the file's primaries, to the very halves that
/// OpenEXR's RgbaInputFile gives: the same functions (ImfRgbaYca.h) in the same order. Rows decode in blocks, and a
/// block needs 14 more rows above and below, which the next block takes over.
/// `picture` outlives the reader. Throws as `RowSource::open_reader`.
[[nodiscard]] std::unique_ptr<RowReader> open_luminance_chroma(const ExrPicture& picture);

/// What such a reader holds beside the library's own blocks, in bytes.
[[nodiscard]] std::uint64_t luminance_chroma_bytes(int width) noexcept;

/// Rows worth decoding together: enough that the 28 rows around them weigh little. At least `unit_rows`.
[[nodiscard]] int luminance_chroma_rows(int unit_rows) noexcept;

}  // namespace welkin::codec
