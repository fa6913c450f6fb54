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

/// Throws `Error` (unsupported_file) if Welkin was built without the codec: names its library, the option that brings
/// it, and what would do instead, `remedy` ("write a Radiance .hdr"). Called where a request names the kind of file,
/// before any work is done for it.
void require_codec(Codec codec, const std::filesystem::path& path, const std::string& remedy);

/// The codec that packs a KTX2's levels so; not for `none`.
[[nodiscard]] Codec codec_of(Supercompression supercompression) noexcept;

/// An OpenEXR file as rows. `file` stands at its beginning and starts with OpenEXR's magic number.
/// Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_exr(platform::ByteFile& file, const ReadOptions& options);

/// A PNG as rows. `file` starts with a PNG's signature. Every colour type and depth is read; alpha is ignored, colours
/// are taken as they are (PNG's are not premultiplied); colours beyond the end of a palette are black.
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

/// A JPEG with a gain map as rows of the image of high dynamic range that the two make, the gains applied in full.
/// `file` starts with a JPEG's first marker. The base image is decoded by sRGB's curve, unless ReadOptions.transfer
/// says linear; an ICC profile's primaries, which gains leave as they are, become Rec. 709 unless wanted as stored. A
/// JPEG without a gain map, or with one that leads from an image of high dynamic range down to an ordinary one, is
/// refused.
///
/// Rows come one after the other from the top, of both images. One that is progressive is held whole by libjpeg, as
/// two bytes a sample. Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_jpeg(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
