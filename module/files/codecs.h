// The codecs that a build can leave out (WELKIN_EXR=OFF and so on), and the readers among them. The sources of a codec
// that is left out are not compiled; codecs.cpp then defines their functions, and each throws.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "files/row_source.h"
#include "platform/file.h"
#include "welkin/bake_file.h"

namespace welkin::files {

enum class Codec { exr, png, webp, zlib, zstd, astc, jpeg };

/// Throws `Error` (unsupported_file) if Welkin was built without the codec. The message names its library, the option
/// that enables it, and an alternative, `remedy` ("write a Radiance .hdr"). Called where a request names the kind of
/// file, before any work is done for it.
void require_codec(Codec codec, const std::filesystem::path& path, const std::string& remedy);

/// Returns the codec of a KTX2's supercompression; not for `none`.
[[nodiscard]] Codec codec_of(Supercompression supercompression) noexcept;

/// Opens an OpenEXR file as rows. `file` is at its beginning and starts with OpenEXR's magic number. Throws the errors
/// of `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_exr(platform::ByteFile& file, const ReadOptions& options);

/// Opens a PNG as rows. `file` starts with a PNG's signature. All colour types and depths are supported; alpha is
/// ignored and colours are used unchanged (PNG's are not premultiplied); colours beyond the end of a palette are black.
///
/// Samples are linearized by sRGB's curve unless ReadOptions.transfer says linear, or is automatic and the file has a
/// gAMA chunk of 1 and no sRGB chunk. Other gAMA values are not applied: nearly all approximate sRGB. With a cHRM chunk
/// and no sRGB chunk, colours become Rec. 709 unless requested as stored. ICC profiles and cICP chunks are not applied.
/// The notes state what was decided.
///
/// A PNG is one stream: rows come in order from the top, and a request for a row above the last one restarts it. An
/// interlaced one is decoded whole at its first row: 3 or 8 bytes per texel. Throws the errors of
/// `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_png(platform::ByteFile& file, const ReadOptions& options);

/// Opens a JPEG with a gain map as rows of the resulting HDR image, with the gains applied in full. `file` starts with
/// a JPEG's first marker. The base image is decoded by sRGB's curve, unless ReadOptions.transfer says linear; an ICC
/// profile's primaries, which gains do not change, become Rec. 709 unless requested as stored. A JPEG without a gain
/// map, or with one that leads from an HDR image down to an ordinary one, is refused.
///
/// Rows of both images come in order from the top. libjpeg holds a progressive image whole, as two bytes per sample.
/// Throws the errors of `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_jpeg(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
