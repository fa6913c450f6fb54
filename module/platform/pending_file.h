// The system-specific part of a `WholeFile`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "platform/file.h"

namespace welkin::platform {

/// A file without a name, or with a temporary one next to its target, until it is whole. Each function returns whether
/// it succeeded; `why` has the reason if not.
class PendingFile {
 public:
  /// `target`: the final path, with all links followed.
  explicit PendingFile(std::filesystem::path target) : target_(std::move(target)) {}
  ~PendingFile();  ///< removes a file that was not put in place
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Makes the file in the folder of its target.
  [[nodiscard]] bool make();
  /// Opens the stream that `write` and `seek` use.
  [[nodiscard]] bool open_stream();
  /// Gives the file the permissions of the one that it will replace, where the system has permissions.
  void set_permissions(std::filesystem::perms permissions) noexcept;
  [[nodiscard]] bool write(const void* bytes, std::size_t count);
  [[nodiscard]] bool seek(std::uint64_t position);
  /// Writes out what the stream has buffered, and closes it.
  [[nodiscard]] bool close_stream();
  /// Waits until all bytes are on the disk.
  [[nodiscard]] bool flush_to_disk();
  /// Renames the file to its target, replacing an existing file. No call may follow.
  [[nodiscard]] bool put_in_place();

  /// Returns the reason for the last failure, as text for people.
  [[nodiscard]] const std::string& why() const noexcept { return why_; }

 private:
  [[nodiscard]] bool make_without_name();  ///< this one and the next two: POSIX only
  [[nodiscard]] bool make_beside();
  [[nodiscard]] bool give_name();
  [[nodiscard]] bool note_failure();               ///< returns false, with the system's reason in `why_`
  [[nodiscard]] bool note_unless(bool succeeded);  ///< returns `succeeded`; if false, with the C library's reason
  void discard() noexcept;

  std::filesystem::path target_;
  std::filesystem::path beside_;  ///< empty while the file has no name
  SystemFile file_ = kNoFile;     ///< locked while its writer lives
  std::FILE* stream_ = nullptr;
  std::string why_;
};

/// The final path of a file, and the permissions of the file that it replaces, if any.
struct PendingTarget {
  std::filesystem::path path;
  std::optional<std::filesystem::perms> permissions;
};

/// Returns the target of a file given as `path`, with links followed unless they are replaced. Removes what a killed
/// process left in its folder, once. Throws `Error` (file_access) where something other than a file is there.
[[nodiscard]] PendingTarget target_of(const std::filesystem::path& path, WholeFile::Link link);

/// Returns a unique name for a hidden temporary file next to `path`: in the same directory, so that renaming is one
/// step.
[[nodiscard]] std::filesystem::path name_beside(const std::filesystem::path& path);

/// Removes a file that `name_beside` named if its writer is gone.
void remove_if_left_behind(const std::filesystem::path& path) noexcept;

/// For a system's functions that try names: after this many collisions the name is not the cause.
inline constexpr int kMaxNamesTried = 100;

}  // namespace welkin::platform
