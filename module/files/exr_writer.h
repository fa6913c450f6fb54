// What the writers of OpenEXR files share.
#pragma once

#include <Iex.h>
#include <ImfIO.h>
#include <half.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <string>

#include "platform/file.h"

namespace welkin::files {

class ExrOutputStream final : public Imf::OStream {
 public:
  /// `file` outlives the stream.
  explicit ExrOutputStream(platform::WholeFile& file) : Imf::OStream(file.path().string().c_str()), file_(file) {}

  void write(const char bytes[], int count) override { file_.write(bytes, static_cast<std::size_t>(count)); }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  platform::WholeFile& file_;
};

/// To the file's type, counting what is clamped. What is finite stays finite: above the largest half, rounding would
/// make it infinite. NaN and infinities stay.
void convert_for_exr(const float* from, std::size_t count, float* to, std::uint64_t& clamped) noexcept;
void convert_for_exr(const float* from, std::size_t count, Imath::half* to, std::uint64_t& clamped) noexcept;

/// Makes OpenEXR's failures `Error`s that name the file. OpenEXR's file objects write their table of offsets when they
/// are destroyed and swallow what goes wrong there. A stream that failed once fails again in `WholeFile::finish`.
template <typename Write>
std::uint64_t write_exr_with_library(const platform::WholeFile& file, const Write& write) {
  try {
    return write();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Iex::BaseExc& failure) {
    throw platform::file_error(
        ErrorCode::file_access, file.path(),
        std::string("could not be written; OpenEXR says: ") + platform::printable(failure.what()));
  }
}

}  // namespace welkin::files
