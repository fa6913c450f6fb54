// Files by POSIX's calls.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "platform/file.h"
#include "platform/pending_file.h"

namespace welkin::platform {

std::int64_t process_number() noexcept { return getpid(); }

std::filesystem::path reachable(const std::filesystem::path& path) { return path; }

SharedFile::SharedFile(const std::filesystem::path& path) noexcept
    : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW)) {}

SharedFile::~SharedFile() {
  if (is_open()) close(file_);
}

std::optional<std::uint64_t> SharedFile::size() const noexcept {
  struct stat status {};
  if (fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return static_cast<std::uint64_t>(status.st_size);
}

bool SharedFile::read(void* bytes, std::size_t count) const noexcept {
  auto* to = static_cast<std::uint8_t*>(bytes);
  while (count > 0) {
    const ssize_t got = ::read(file_, to, count);
    if (got <= 0) return false;
    to += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

void SharedFile::touch() const noexcept { static_cast<void>(futimens(file_, nullptr)); }

FolderLock::FolderLock(const std::filesystem::path& folder) noexcept
    : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}

FolderLock::~FolderLock() {
  if (file_ != kNoFile) close(file_);
}

// NOLINTNEXTLINE(readability-make-member-function-const): elsewhere it changes what is held
bool FolderLock::take() noexcept { return flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

namespace {

/// Returns whether the descriptor's file is the one of that name.
bool is_file_of(int descriptor, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

/// Returns a path to a file that has no name.
std::string descriptor_path(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

}  // namespace

void remove_if_left_behind(const std::filesystem::path& path) noexcept {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
  if (descriptor < 0) return;
  // A living writer holds the lock or has moved on to another name (see `make_beside`).
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && is_file_of(descriptor, path)) unlink(path.c_str());
  close(descriptor);
}

bool PendingFile::note_failure() { return note_unless(false); }

void PendingFile::discard() noexcept {
  if (!beside_.empty()) unlink(beside_.c_str());
  beside_.clear();
  if (file_ != kNoFile) close(std::exchange(file_, kNoFile));
}

bool PendingFile::make() { return make_without_name() || make_beside(); }

/// Returns false where the file system has no unnamed files or the system offers no paths to them.
bool PendingFile::make_without_name() {
#ifdef O_TMPFILE
  const std::filesystem::path folder = target_.has_parent_path() ? target_.parent_path() : ".";
  file_ = open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
  if (file_ == kNoFile) return false;
  if (access(descriptor_path(file_).c_str(), F_OK) != 0) {
    close(std::exchange(file_, kNoFile));
    return false;
  }
  static_cast<void>(flock(file_, LOCK_EX | LOCK_NB));  // for the moment in which it has a temporary name
  return true;
#else
  return false;
#endif
}

bool PendingFile::make_beside() {
  for (int tried = 0; file_ == kNoFile && tried < kMaxNamesTried; ++tried) {
    beside_ = name_beside(target_);
    errno = 0;
    file_ = open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ == kNoFile && errno != EEXIST) break;
    // A process that tidies the folder may have come between, and holds the lock or has removed the file.
    const bool locked = flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
    if (!locked || !is_file_of(file_, beside_)) close(std::exchange(file_, kNoFile));
  }
  if (file_ != kNoFile) return true;
  beside_.clear();
  return note_failure();
}

bool PendingFile::open_stream() {
  const int copy = fcntl(file_, F_DUPFD_CLOEXEC, 0);  // for the stream, which closes its descriptor
  if (copy >= 0) stream_ = fdopen(copy, "wb");
  if (stream_ != nullptr) return true;
  static_cast<void>(note_failure());
  if (copy >= 0) close(copy);
  return false;
}

// NOLINTNEXTLINE(readability-make-member-function-const): it changes the file
void PendingFile::set_permissions(std::filesystem::perms permissions) noexcept {
  // Best effort: a file system without permissions has none to lose.
  static_cast<void>(fchmod(file_, static_cast<mode_t>(permissions & std::filesystem::perms::all)));
}

bool PendingFile::seek(std::uint64_t position) {
  errno = 0;
  return note_unless(fseeko(stream_, static_cast<off_t>(position), SEEK_SET) == 0);
}

bool PendingFile::flush_to_disk() {
  // A file system that cannot flush (EINVAL) does not lose what it has.
  return fdatasync(file_) == 0 || errno == EINVAL || note_failure();
}

/// Names an unnamed file: as its target if that is free, else temporarily, because a link replaces nothing.
bool PendingFile::give_name() {
  const std::string unnamed = descriptor_path(file_);
  const auto link_to = [&](const std::filesystem::path& name) {
    return linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  };
  bool named = link_to(target_);
  if (named) return true;
  for (int tried = 0; !named && errno == EEXIST && tried < kMaxNamesTried; ++tried) {
    beside_ = name_beside(target_);
    named = link_to(beside_);
  }
  if (named) return true;
  beside_.clear();
  return note_failure();
}

bool PendingFile::put_in_place() {
  if (beside_.empty() && !give_name()) return false;
  if (!beside_.empty() && std::rename(beside_.c_str(), target_.c_str()) != 0) return note_failure();
  beside_.clear();
  discard();
  return true;
}

}  // namespace welkin::platform
