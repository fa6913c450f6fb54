// Files: read at given positions, shared with other processes, or replaced as a whole.
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

/// The system's identifier of an open file: POSIX's descriptor, or a Windows handle as a number.
#if defined(_WIN32)
using SystemFile = std::intptr_t;
#else
using SystemFile = int;
#endif
inline constexpr SystemFile kNoFile = -1;

/// Returns the number of this process, which a fork of it does not share.
[[nodiscard]] std::int64_t process_number() noexcept;

/// Returns the path by which the system's calls reach a file whatever the length of its name. Windows: from 248
/// characters on, the absolute path in the form without a length limit; elsewhere the path itself.
[[nodiscard]] std::filesystem::path reachable(const std::filesystem::path& path);

/// A regular file that is open for reading.
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

/// Opens a regular file. Throws `Error` (file_access) naming the file and why it cannot be opened.
[[nodiscard]] std::unique_ptr<DiskFile> open_disk_file(const std::filesystem::path& path);

/// The bytes of a file and a position in them: a regular file that is open for reading, or named bytes in memory. Not
/// for use from two threads at once: each opens its own.
class ByteFile {
 public:
  /// `memory`: the bytes, which must outlive this; `path` is then their name. Without it the file is opened.
  /// Throws `Error` (file_access) naming the file and why it cannot be opened.
  explicit ByteFile(std::filesystem::path path, std::optional<std::span<const std::byte>> memory = std::nullopt);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Returns the bytes in memory; nullopt if the file was opened by its path.
  [[nodiscard]] const std::optional<std::span<const std::byte>>& memory() const noexcept { return memory_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
  [[nodiscard]] std::uint64_t remaining() const noexcept { return position_ < size_ ? size_ - position_ : 0; }

  /// Accepts any position; only reading past the end fails.
  void seek(std::uint64_t position) noexcept { position_ = position; }

  /// Reads exactly `count` bytes from the current position and moves past them. Throws `Error`: corrupt_file if the
  /// file ends earlier, file_access if the system cannot read.
  void read(void* bytes, std::size_t count);

 private:
  std::filesystem::path path_;
  std::optional<std::span<const std::byte>> memory_;
  std::unique_ptr<DiskFile> disk_;  // null where the bytes are in memory
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;  // where the next read starts
};

/// Returns text that is safe in a terminal: control characters, also those from U+0080 to U+009F, those that change the
/// direction of text, and bytes that are not UTF-8 become '?'.
[[nodiscard]] std::string without_controls(std::string_view text);

/// Returns an `Error` whose message begins with the file's name, without control characters. If the message about a
/// corrupt file names no remedy (after "; "), one is appended.
[[nodiscard]] Error file_error(ErrorCode code, const std::filesystem::path& path, const std::string& message);

/// Returns text of a file for use in a message: control and non-ASCII characters become '?', at most 200 characters.
[[nodiscard]] std::string printable(const std::string& text);

// A file that other processes may remove or replace at any time.

/// A file opened for reading. Opening never waits, not even for a pipe, and follows no link; no function throws.
class SharedFile {
 public:
  explicit SharedFile(const std::filesystem::path& path) noexcept;
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  [[nodiscard]] bool is_open() const noexcept { return file_ != kNoFile; }

  /// Returns the size in bytes; empty if this is not a regular file.
  [[nodiscard]] std::optional<std::uint64_t> size() const noexcept;

  /// Reads exactly `count` bytes from the end of the last read. False if the file ends earlier or cannot be read.
  [[nodiscard]] bool read(void* bytes, std::size_t count) const noexcept;

  /// Sets the modification time to now, where the system allows it.
  void touch() const noexcept;

 private:
  SystemFile file_;
};

/// A lock on a folder, held by one writer at a time, in this process and in others.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder) noexcept;
  ~FolderLock();  ///< releases the folder, as the end of the process does
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Takes the lock without waiting. Returns false if another writer holds it, true where the folder cannot be locked.
  [[nodiscard]] bool take() noexcept;

 private:
  SystemFile file_;
};

// A file that is whole or not there.

class PendingFile;  // its system-specific part

/// A file that appears as a whole. It is written without a name where the file system supports that (Linux: O_TMPFILE),
/// else under a temporary name next to its target, and moved to its target by `commit`. Destroyed before that, it
/// leaves nothing behind; what a killed process left under a name is removed by the next that writes to the folder. The
/// permissions of a replaced file are kept. All throw `Error` (file_access) naming the file, the reason and a remedy.
///
/// In memory the bytes are gathered in a separate vector, which `commit` moves to the caller.
class WholeFile {
 public:
  /// The treatment of a symbolic link at the target.
  enum class Link {
    kept,     ///< the link stays, and the file that it leads to is replaced
    replaced  ///< the file that it leads to stays as it is
  };

  /// `memory`: receives the bytes instead of a file; it must outlive this object, and `path` is then their name.
  explicit WholeFile(std::filesystem::path path, std::vector<std::byte>* memory = nullptr, Link link = Link::kept);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

  void write(const void* bytes, std::size_t count);
  void seek(std::uint64_t position);

  /// Writes out what is buffered. A full disk is reported here at the latest, even if a library swallowed the first
  /// failure. `to_disk`: waits until the bytes are on the disk, so that a name that outlives a power failure has all of
  /// its bytes.
  void finish(bool to_disk = false);

  /// Names the file, after `finish`. An existing file is replaced.
  void commit();

 private:
  void write_to_memory(const void* bytes, std::size_t count);
  [[noreturn]] void fail(const char* what, const std::string& why);

  std::filesystem::path path_;            // as given, for messages
  std::vector<std::byte>* memory_;        // of the caller
  std::vector<std::byte> gathered_;       // bytes for `memory_`
  std::unique_ptr<PendingFile> pending_;  // null for bytes in memory
  std::uint64_t position_ = 0;
  std::string failure_;  // the system's reason for the first failure
  bool failed_ = false;
};

/// Removes the named temporary files of a folder whose writers are gone: a living writer holds a lock on its file
/// (POSIX: flock; Windows: a handle). No other file is touched; a file that cannot be removed stays.
void remove_left_behind(const std::filesystem::path& folder) noexcept;

// Integers as the texture formats store them: least significant byte first.

// Texels are copied between memory and file unchanged.
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
