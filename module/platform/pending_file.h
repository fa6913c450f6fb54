// What a system does for a `WholeFile`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "platform/file.h"

namespace welkin::platform {

/// A file that has no name yet, or one of its own beside its place, until it is whole. Each function returns whether it
/// succeeded; `why` has the reason then.
class PendingFile {
 public:
  /// `place`: where the file belongs, behind all links.
  explicit PendingFile(std::filesystem::path place) : place_(std::move(place)) {}
  ~PendingFile();  ///< what was not put in its place is gone
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Makes the file in the folder of its place.
  [[nodiscard]] bool make();
  /// Opens the stream that `write` and `seek` use.
  [[nodiscard]] bool open_stream();
  /// Gives the file the permissions of the one that it will replace, where the system has such.
  void set_permissions(std::filesystem::perms permissions) noexcept;
  [[nodiscard]] bool write(const void* bytes, std::size_t count);
  [[nodiscard]] bool seek(std::uint64_t position);
  /// Writes out what the stream has buffered, and closes it.
  [[nodiscard]] bool close_stream();
  /// Waits until the disk has all.
  [[nodiscard]] bool flush_to_disk();
  /// Gives it its name; what has that name is replaced. Nothing may follow.
  [[nodiscard]] bool put_in_place();

  /// Why the last function failed, as a text for people.
  [[nodiscard]] const std::string& why() const noexcept { return why_; }

 private:
  [[nodiscard]] bool make_without_name();  ///< this one and the next two: POSIX alone
  [[nodiscard]] bool make_beside();
  [[nodiscard]] bool give_name();
  [[nodiscard]] bool note_failure();               ///< false, with the system's reason in `why_`
  [[nodiscard]] bool note_unless(bool succeeded);  ///< if not: false, with the C library's reason
  void discard() noexcept;

  std::filesystem::path place_;
  std::filesystem::path beside_;  ///< empty while it has no name
  SystemFile file_ = kNoFile;     ///< holds the lock that says that its writer lives
  std::FILE* stream_ = nullptr;
  std::string why_;
};

/// Where a file will be, and the permissions of what it replaces there, if something it does.
struct PendingTarget {
  std::filesystem::path path;
  std::optional<std::filesystem::perms> permissions;
};

/// The place of a file that is asked for as `path`: behind all links, unless they are replaced. Removes what a killed
/// process left in its folder, once. Throws `Error` (file_access) where something else than a file is there.
[[nodiscard]] PendingTarget place_of(const std::filesystem::path& path, WholeFile::Link link);

/// A name for a temporary file beside `path`: in the same directory, so that renaming is one step; hidden, and no other
/// process's or call's.
[[nodiscard]] std::filesystem::path name_beside(const std::filesystem::path& path);

/// Removes a file that `name_beside` named if its writer is gone.
void remove_if_left_behind(const std::filesystem::path& path) noexcept;

/// For a system's functions that try names: after so many that are taken it is not the name.
inline constexpr int kMaxNamesTried = 100;

}  // namespace welkin::platform
