// Files: read at stated places, shared with other processes, or replaced as a whole.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "welkin/core.h"

namespace welkin::platform {

/// What a system knows an open file by: POSIX's descriptor, or a handle of Windows as a number.
#if defined(_WIN32)
using SystemFile = std::intptr_t;
#else
using SystemFile = int;
#endif
inline constexpr SystemFile kNoFile = -1;

/// The number of this process, which a fork of it does not have.
[[nodiscard]] std::int64_t process_number() noexcept;

/// The path by which the system's calls reach a file whatever the length of its name. Windows: from 248 characters on,
/// the absolute path in the form that has no bound; elsewhere the path itself.
[[nodiscard]] std::filesystem::path reachable(const std::filesystem::path& path);

/// A regular file that is opened for reading.
class DiskFile {
 public:
  DiskFile() = default;
  virtual ~DiskFile() = default;
  DiskFile(const DiskFile&) = delete;
  DiskFile& operator=(const DiskFile&) = delete;

  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
  /// Reads exactly `count` bytes from `position` on. Throws `Error` (file_access) if the system cannot.
  virtual void read(std::uint64_t position, void* bytes, std::size_t count) = 0;
};

/// Throws `Error` (file_access) naming the file and why it cannot be opened.
[[nodiscard]] std::unique_ptr<DiskFile> open_disk_file(const std::filesystem::path& path);

/// The bytes of a file and a place in them: a regular file that is opened for reading, or bytes in memory that have a
/// name. Not for use from two threads at once: each opens its own.
class ByteFile {
 public:
  /// `memory`: the bytes, which must outlive this; `path` is then their name. Without it the file is opened.
  /// Throws `Error` (file_access) naming the file and why it cannot be opened.
  explicit ByteFile(std::filesystem::path path, std::optional<std::span<const std::byte>> memory = std::nullopt);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Nothing if the file was opened by its path.
  [[nodiscard]] const std::optional<std::span<const std::byte>>& memory() const noexcept { return memory_; }
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
  std::optional<std::span<const std::byte>> memory_;
  std::unique_ptr<DiskFile> disk_;  // null where the bytes are in memory
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;  // where the next read starts
};

/// Text for a terminal: what could steer one becomes '?', that is control characters, of the upper half too (U+0080 to
/// U+009F), those that turn the direction of text, and bytes that are no UTF-8.
[[nodiscard]] std::string without_controls(std::string_view text);

/// Returns an `Error` whose message begins with the file's name, without control characters. A message about a corrupt
/// file that names no remedy (after "; ") is given one.
[[nodiscard]] Error file_error(ErrorCode code, const std::filesystem::path& path, const std::string& message);

/// Text out of a file, fit for a message: control and non-ASCII characters become '?', at most 200 characters.
[[nodiscard]] std::string printable(const std::string& text);

// A file that other processes may remove or replace at any time.

/// Opened for reading. Opening never waits, not even for a pipe of that name, and follows no link; no function throws.
class SharedFile {
 public:
  explicit SharedFile(const std::filesystem::path& path) noexcept;
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  [[nodiscard]] bool is_open() const noexcept { return file_ != kNoFile; }

  /// In bytes. Empty if this is not a regular file.
  [[nodiscard]] std::optional<std::uint64_t> size() const noexcept;

  /// Reads exactly `count` bytes from where the last read ended. False if the file ends before, or cannot be read.
  [[nodiscard]] bool read(void* bytes, std::size_t count) const noexcept;

  /// Sets the time of its last change to now, where the system allows it.
  void touch() const noexcept;

 private:
  SystemFile file_;
};

/// A folder that one at a time writes to, of all who take it, in this process and in others.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder) noexcept;
  ~FolderLock();  ///< gives the folder back, as the end of the process does
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Without waiting: false if another has it. Whose folder cannot be locked has it at once.
  [[nodiscard]] bool take() noexcept;

 private:
  SystemFile file_;
};

// A file that is whole or not there.

class PendingFile;  // what the system does for it

/// Written without a name where the file system has such files (Linux: O_TMPFILE), else beside its place under a name
/// of its own, and put in place by `commit`. Whoever destroys it before that leaves nothing behind; what a killed
/// process left under a name, the next process removes that writes to the folder. What it replaces hands on its
/// permissions. All throw `Error` (file_access) naming the file, the system's reason and a remedy.
///
/// In memory the bytes are gathered in a vector of its own, which becomes the caller's by `commit`.
class WholeFile {
 public:
  /// What becomes of a symbolic link that stands in the file's place.
  enum class Link {
    kept,     ///< it stays, and the file that it leads to is replaced
    replaced  ///< what it leads to stays as it is
  };

  /// `memory`: where the bytes go, if not to a file; it must outlive this, and `path` is then their name.
  explicit WholeFile(std::filesystem::path path, std::vector<std::byte>* memory = nullptr, Link link = Link::kept);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

  void write(const void* bytes, std::size_t count);
  void seek(std::uint64_t position);

  /// Writes out what is buffered. What did not fit on the disk fails here at the latest, also if a library swallowed
  /// the first failure. `to_disk`: waits until the disk has it, so that a name that outlives a power failure is that of
  /// all the bytes.
  void finish(bool to_disk = false);

  /// After `finish`: gives the file its name. Replaces what is there.
  void commit();

 private:
  void write_to_memory(const void* bytes, std::size_t count);
  [[noreturn]] void fail(const char* what, const std::string& why);

  std::filesystem::path path_;            // as it was asked for, for messages
  std::vector<std::byte>* memory_;        // the caller's
  std::vector<std::byte> gathered_;       // of what goes to memory
  std::unique_ptr<PendingFile> pending_;  // of what goes to a file
  std::uint64_t position_ = 0;
  std::string failure_;  // the system's reason for the first one
  bool failed_ = false;
};

/// Removes the named temporary files of a folder whose writers are gone: they hold a lock on them (POSIX: flock;
/// Windows: a handle) for as long as they live. No other file is touched; what fails is left there.
void remove_left_behind(const std::filesystem::path& folder) noexcept;

// Integers as the texture formats store them: least significant byte first.

// Texels are copied between memory and file as they are.
static_assert(std::endian::native == std::endian::little, "texture files need their byte order turned here");

template <std::unsigned_integral Value>
[[nodiscard]] Value read_little_endian(const std::uint8_t* bytes) noexcept {
  Value value{};
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <std::unsigned_integral Value>
void append_little_endian(std::vector<std::uint8_t>& bytes, Value value) {
  const std::size_t index = bytes.size();
  bytes.resize(index + sizeof value);
  std::memcpy(bytes.data() + index, &value, sizeof value);
}

}  // namespace welkin::platform
