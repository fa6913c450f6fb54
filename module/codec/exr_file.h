// A handle on one part of an OpenEXR file: one for every reader.
#pragma once

#include <ImfFrameBuffer.h>
#include <ImfMultiPartInputFile.h>

#include "codec/byte_file.h"
#include "codec/exr_picture.h"
#include "codec/exr_stream.h"

namespace welkin::codec {

/// Decoding is done by whoever calls, on as many readers as it likes: the library's own thread pool is left
/// as the program has it, and no reader asks for any of it.
///
/// Where the table of offsets is not written in whole (all zero by OpenImageIO if `textureformat` is set, or of a file
/// whose writer was stopped), the library finds the blocks itself on opening.
struct ExrFile {
  /// Throws `Error`: file_access if the file is not the one that `picture` was made from.
  explicit ExrFile(const ExrPicture& picture);

  ByteFile bytes;
  ExrStream stream;
  Imf::MultiPartInputFile file;
};

/// Where the library is to put a channel: texel (column, row) of the file's coordinates at `first`, the next ones
/// `texel_bytes` and `row_bytes` on. (It expects the address that texel (0, 0) would have, which may lie outside of
/// anything, and so is worked out in integers.) Channels sampled at every second texel have `sampling` 2.
[[nodiscard]] Imf::Slice exr_slice(Imf::PixelType type, void* first, int column, int row, std::size_t texel_bytes,
                                   std::size_t row_bytes, int sampling = 1);

}  // namespace welkin::codec
