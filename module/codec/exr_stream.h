// The seam to the OpenEXR library: its stream over our file, and its exceptions as ours. Included by the
// exr_ sources alone, which alone know the library.
#pragma once

#include <Iex.h>
#include <ImfIO.h>

#include <exception>
#include <new>

#include "codec/byte_file.h"

namespace welkin::codec {

class ExrStream final : public Imf::IStream {
 public:
  /// `file` outlives the stream.
  explicit ExrStream(ByteFile& file) : Imf::IStream(file.path().string().c_str()), file_(file) {}

  bool read(char bytes[], int count) override {
    if (count < 0) {
      throw file_error(ErrorCode::corrupt_file, file_.path(), "holds a block of negative size");
    }
    file_.read(bytes, static_cast<std::size_t>(count));
    return file_.remaining() > 0;
  }
  std::uint64_t tellg() override { return file_.position(); }
  void seekg(std::uint64_t position) override { file_.seek(position); }

 private:
  ByteFile& file_;
};

/// Runs `work`, which calls OpenEXR, and turns whatever that throws into `Error`s that name the file.
template <typename Work>
auto call_openexr(const std::filesystem::path& path, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const Iex::ErrnoExc& failure) {
    throw file_error(ErrorCode::file_access, path, std::string("OpenEXR says: ") + printable(failure.what()));
  } catch (const std::bad_alloc&) {
    throw file_error(ErrorCode::limit_exceeded, path,
                     "decoding it takes more memory than there is; free some, or save it with smaller tiles");
  } catch (const std::exception& failure) {
    throw file_error(ErrorCode::corrupt_file, path,
                     std::string("is damaged, fetch or export it again; OpenEXR says: ") + printable(failure.what()));
  }
}

}  // namespace welkin::codec
