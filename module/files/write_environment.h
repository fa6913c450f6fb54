// An image that is about to be written: a view in the file's layout, row by row.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "files/layout.h"
#include "platform/file.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::files {

/// Rows of RGB floats, row 0 on top.
class OutputImage {
 public:
  explicit OutputImage(const LatLongView& view);
  /// All six faces by the placement; blank texels are black. The placement must outlive the image.
  OutputImage(const CubemapView& view, const CubePlacement& placement);
  /// A single face.
  OutputImage(const CubemapView& view, int face);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }

  /// Writes a row to `width` x 3 floats.
  void read_row(int row, float* rgb) const { read_row_(row, rgb); }

 private:
  int width_ = 0;
  int height_ = 0;
  std::function<void(int row, float* rgb)> read_row_;
};

/// Values of an OpenEXR file's envmap attribute.
enum class Envmap { none, lat_long, cube };

/// Data that the writers share in addition to the image.
struct WriteJob {
  platform::WholeFile& file;
  SampleType type;
  Envmap envmap;
  const Control& control;
};

/// Returns the files for an image of this layout at `path`: one, or one per face in their order.
[[nodiscard]] std::vector<std::filesystem::path> files_to_write(const std::filesystem::path& path, Layout layout);

/// Returns "level_three.ktx2" for "level.json".
[[nodiscard]] std::filesystem::path beside(const std::filesystem::path& path, const std::string& ending,
                                           const std::filesystem::path& extension = {});

/// Returns the entry of `formats` whose extension the path has. Throws `Error` (unsupported_file) if there is none.
template <class Formats>
[[nodiscard]] const auto& format_named_by(const std::filesystem::path& path, const Formats& formats,
                                          const char* verdict, const char* remedy) {
  const std::string extension = lower_case(platform::utf8(path.extension()));
  for (const auto& format : formats) {
    if (extension == format.extension) return format;
  }
  throw platform::file_error(ErrorCode::unsupported_file, path,
                             (extension.empty() ? std::string("has no extension that names a format")
                                                : "\"" + platform::printable(extension) + "\"" + verdict) +
                                 remedy);
}

/// Files that appear together, once all of them are whole.
class OutputFiles {
 public:
  platform::WholeFile& add(const FileOutput& output);

  /// Moves all files to their paths: an exception before the first one leaves the old files unchanged. Reports the end
  /// of the work.
  [[nodiscard]] WriteReport commit(std::uint64_t values_clamped, const Control& control);

 private:
  std::vector<std::unique_ptr<platform::WholeFile>> files_;
};

/// Called before each row or block of rows: throws `Error` (cancelled), and reports the fraction done.
void report_rows(const WriteJob& job, int done, int height);

/// Each writes the image to the job's file and returns how many values were clamped. Throws the errors of
/// `write_environment`.
std::uint64_t write_exr(const OutputImage& image, const WriteJob& job);
std::uint64_t write_hdr(const OutputImage& image, const WriteJob& job);
std::uint64_t write_pfm(const OutputImage& image, const WriteJob& job);
std::uint64_t write_png(const OutputImage& image, const WriteJob& job);

}  // namespace welkin::files
