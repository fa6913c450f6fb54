// A file that is whole or not there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>

namespace welkin::codec {

/// Written beside its place under a name of its own, and put in place by `commit`. Whoever destroys it before that
/// leaves nothing behind. What it replaces hands on its permissions; a symbolic link stays one, and the file that it
/// leads to is replaced. All throw `Error` (file_access) naming the file, the system's reason and a remedy.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path path);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

  void write(const void* bytes, std::size_t count);
  void seek(std::uint64_t position);

  /// Writes out what is buffered. What did not fit on the disk fails here at the latest, also if a library swallowed
  /// the first failure.
  void finish();

  /// After `finish`: renames. Replaces what is there.
  void commit();

 private:
  [[noreturn]] void fail(const char* what);

  std::filesystem::path path_;   // as it was asked for, for messages
  std::filesystem::path place_;  // where it goes: behind all links
  std::filesystem::path beside_;
  std::FILE* stream_ = nullptr;
  std::uint64_t position_ = 0;
  int failure_ = 0;  // the system's number of the first one
  bool failed_ = false;
};

}  // namespace welkin::codec
