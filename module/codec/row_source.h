// A picture in a file, as rows of RGB floats.
//
// Opening a source reads and checks the header and decodes nothing. Readers are independent of one another,
// each with its own handle on the file, so that blocks of rows decode side by side, one reader a thread,
// without a lock.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "welkin/environment_file.h"

namespace welkin::codec {

/// The largest picture that any layout can hold; what claims to be larger is refused by its header.
inline constexpr int kMaximumWidth = 65536;
inline constexpr int kMaximumHeight = 6 * 16384;

class RowReader {
 public:
  virtual ~RowReader() = default;

  /// Decodes rows [first_row, first_row + row_count) of the picture, row 0 on top, to
  /// row_count x width x 3 floats. The range is the caller's to keep inside the picture.
  /// Throws `Error`: corrupt_file, file_access, limit_exceeded. After that the reader is not to be used.
  virtual void read(int first_row, int row_count, float* rgb) = 0;
};

class RowSource {
 public:
  virtual ~RowSource() = default;

  [[nodiscard]] const EnvironmentInfo& info() const noexcept { return info_; }

  /// Rows that decode together: a compressed block of scanlines, a row of tiles. At least 1, at most the
  /// height. Reading multiples of it from multiples of it decodes everything once.
  [[nodiscard]] virtual int natural_rows() const = 0;

  /// An upper bound, by the header alone, on what one reader holds in memory.
  [[nodiscard]] virtual std::uint64_t reader_bytes() const = 0;

  /// The reader must not outlive the source. Throws as `RowReader::read`.
  [[nodiscard]] virtual std::unique_ptr<RowReader> open_reader() const = 0;

 protected:
  explicit RowSource(EnvironmentInfo info) : info_(std::move(info)) {}

 private:
  EnvironmentInfo info_;
};

/// Opens a file of any kind that is read, by its first bytes. Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_row_source(const std::filesystem::path& path, const ReadOptions& options);

/// Bytes of `rows` rows of `width` RGB float texels. Within a picture's bounds this cannot overflow.
[[nodiscard]] constexpr std::uint64_t rgb_bytes(int width, int rows) noexcept {
  return std::uint64_t{12} * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(rows);
}

}  // namespace welkin::codec
