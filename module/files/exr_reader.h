// The seam to the OpenEXR library: its stream over our file, and its exceptions as ours. Included by the
// exr_ sources alone, which alone know the library.
#pragma once

#include <Iex.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>
#include <ImfMultiPartInputFile.h>

#include <cstdint>
#include <exception>
#include <memory>
#include <new>

#include "files/exr_picture.h"
#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

class ExrStream final : public Imf::IStream {
 public:
  /// `file` outlives the stream.
  explicit ExrStream(platform::ByteFile& file) : Imf::IStream(file.path().string().c_str()), file_(file) {}

  bool read(char bytes[], int count) override {
    if (count < 0) {
      throw platform::file_error(ErrorCode::corrupt_file, file_.path(), "holds a block of negative size");
    }
    file_.read(bytes, static_cast<std::size_t>(count));
    return file_.remaining() > 0;
  }
  std::uint64_t tellg() override { return file_.position(); }
  void seekg(std::uint64_t position) override { file_.seek(position); }

 private:
  platform::ByteFile& file_;
};

/// Runs `work`, which calls OpenEXR, and turns whatever that throws into `Error`s that name the file.
template <typename Work>
auto call_openexr(const std::filesystem::path& path, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const Iex::ErrnoExc& failure) {
    throw platform::file_error(ErrorCode::file_access, path,
                               std::string("OpenEXR says: ") + platform::printable(failure.what()));
  } catch (const std::bad_alloc&) {
    throw platform::file_error(ErrorCode::limit_exceeded, path,
                               "decoding it takes more memory than there is; free some, or save it with smaller tiles");
  } catch (const std::exception& failure) {
    throw platform::file_error(
        ErrorCode::corrupt_file, path,
        std::string("is damaged, fetch or export it again; OpenEXR says: ") + platform::printable(failure.what()));
  }
}

// A handle on one part of an OpenEXR file: one for every reader.

/// Decoding is done by whoever calls, on as many readers as it likes: the library's own thread pool is left
/// as the program has it, and no reader asks for any of it.
///
/// Where the table of offsets is not written in whole (all zero by OpenImageIO if `textureformat` is set, or of a file
/// whose writer was stopped), the library finds the blocks itself on opening.
struct ExrFile {
  /// Throws `Error`: file_access if the file is not the one that `picture` was made from.
  explicit ExrFile(const ExrPicture& picture);

  platform::ByteFile bytes;
  ExrStream stream;
  Imf::MultiPartInputFile file;
};

/// Where the library is to put a channel: texel (column, row) of the file's coordinates at `first`, the next ones
/// `texel_bytes` and `row_bytes` on. (It expects the address that texel (0, 0) would have, which may lie outside of
/// anything, and so is worked out in integers.) Channels sampled at every second texel have `sampling` 2.
[[nodiscard]] Imf::Slice exr_slice(Imf::PixelType type, void* first, int column, int row, std::size_t texel_bytes,
                                   std::size_t row_bytes, int sampling = 1);

// OpenEXR pictures of luminance and subsampled chroma, as RGB rows.

/// A reader of the stored rows (data_width x data_height) as RGB in the file's primaries, to the very halves that
/// OpenEXR's RgbaInputFile gives: the same functions (ImfRgbaYca.h) in the same order. Rows decode in blocks, and a
/// block needs 14 more rows above and below, which the next block takes over.
/// `picture` outlives the reader. Throws as `RowSource::open_reader`.
[[nodiscard]] std::unique_ptr<RowReader> open_luminance_chroma(const ExrPicture& picture);

/// What such a reader holds beside the library's own blocks, in bytes.
[[nodiscard]] std::uint64_t luminance_chroma_bytes(int width) noexcept;

/// Rows worth decoding together: enough that the 28 rows around them weigh little. At least `unit_rows`.
[[nodiscard]] int luminance_chroma_rows(int unit_rows) noexcept;

}  // namespace welkin::files
