// A file that is read at stated places and never past its end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "welkin/error.h"

namespace welkin::codec {

/// A regular file, opened for reading. Not for use from two threads at once: each opens its own.
class ByteFile {
 public:
  /// Throws `Error` (file_access) naming the file and why it cannot be opened.
  explicit ByteFile(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
  [[nodiscard]] std::uint64_t remaining() const noexcept { return position_ < size_ ? size_ - position_ : 0; }

  /// Any place is allowed; reading past the end is what fails.
  void seek(std::uint64_t position) noexcept { position_ = position; }

  /// Reads exactly `count` bytes from the current position and moves past them.
  /// Throws `Error`: corrupt_file if the file ends before, file_access if the system cannot read.
  void read(void* bytes, std::size_t count);

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;         // where the next read starts
  std::uint64_t stream_position_ = 0;  // where the stream stands; it is moved only when a read needs it
};

/// An `Error` whose message begins with the file's name.
[[nodiscard]] Error file_error(ErrorCode code, const std::filesystem::path& path, const std::string& message);

/// Text out of a file, fit for a message: control and non-ASCII characters become '?', at most 200 characters.
[[nodiscard]] std::string printable(const std::string& text);

}  // namespace welkin::codec
