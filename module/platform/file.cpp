#include "platform/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <exception>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace welkin::platform {
namespace {

// Anything but a regular file is refused before it is opened: a pipe would block, a directory opens and then
// reads nothing.
void require_regular_file(const std::filesystem::path& path) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(path, failure);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw file_error(ErrorCode::file_access, path, "there is no such file");
  }
  if (failure) {
    throw file_error(ErrorCode::file_access, path, "cannot be looked at: " + failure.message());
  }
  if (status.type() == std::filesystem::file_type::directory) {
    throw file_error(ErrorCode::file_access, path, "is a directory; name a picture in it");
  }
  if (status.type() != std::filesystem::file_type::regular) {
    throw file_error(ErrorCode::file_access, path, "is not a regular file; copy what it yields to a file first");
  }
}

}  // namespace

ByteFile::ByteFile(const std::filesystem::path& path, std::optional<std::span<const std::byte>> memory)
    : path_(path), memory_(memory) {
  if (memory_) {
    size_ = memory_->size();
    return;
  }
  require_regular_file(path);
  errno = 0;
  stream_.open(path, std::ios::binary);
  if (!stream_) {
    const std::string reason = errno != 0 ? std::generic_category().message(errno) : "the system does not say why";
    throw file_error(ErrorCode::file_access, path, "cannot be opened: " + reason);
  }
  std::error_code failure;
  size_ = std::filesystem::file_size(path, failure);
  if (failure) {
    throw file_error(ErrorCode::file_access, path, "its size cannot be found: " + failure.message());
  }
}

void ByteFile::read(void* bytes, std::size_t count) {
  if (count > remaining()) {
    throw file_error(ErrorCode::corrupt_file, path_,
                     "ends too early: " + std::to_string(count) + " bytes are wanted at " + std::to_string(position_) +
                         ", the file has " + std::to_string(size_) + " in all; fetch or export it again");
  }
  if (!memory_) {
    read_stream(bytes, count);
  } else if (count > 0) {  // no bytes may be at no address, which memcpy may not be given
    std::memcpy(bytes, memory_->data() + position_, count);
  }
  position_ += count;
}

void ByteFile::read_stream(void* bytes, std::size_t count) {
  if (position_ != stream_position_) {
    stream_.seekg(static_cast<std::streamoff>(position_));
  }
  stream_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(count));
  if (!stream_) {
    throw file_error(ErrorCode::file_access, path_,
                     "could not be read at byte " + std::to_string(position_) + "; is it being written or moved?");
  }
  stream_position_ = position_ + count;
}

namespace {

/// The length of the character of UTF-8 that the text begins with; 0: these bytes are none. (RFC 3629, section 4: some
/// first bytes leave less room for the second, which keeps out longer forms of other characters, halves of UTF-16's
/// pairs and what is above U+10FFFF.)
std::size_t character_bytes(std::string_view text) {
  constexpr unsigned kContinuation = 0x80;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != kContinuation) return 0;
  }
  const unsigned second = length > 1 ? byte(1) : 0;
  const bool is_another = (first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) ||
                          (first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90);
  return is_another ? 0 : length;
}

/// What turns the direction of the text after it, U+202A to U+202E and U+2066 to U+2069, is one too: with it a name
/// reads as another.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  if (character.size() == 2) return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
  return (character >= "\xE2\x80\xAA" && character <= "\xE2\x80\xAE") ||
         (character >= "\xE2\x81\xA6" && character <= "\xE2\x81\xA9");
}

}  // namespace

std::string without_controls(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = character_bytes(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0 || is_control(character)) {
      result += '?';
    } else {
      result += character;
    }
    text.remove_prefix(character.size());
  }
  return result;
}

Error file_error(ErrorCode code, const std::filesystem::path& path, const std::string& message) {
  return {code, without_controls(path.string()) + ": " + message};
}

std::string printable(const std::string& text) {
  constexpr std::size_t kLongest = 200;
  std::string result = text.substr(0, kLongest);
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text.size() > kLongest ? result + "..." : result;
}

SharedFile::SharedFile(const std::filesystem::path& path) noexcept
    : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW)) {}

SharedFile::~SharedFile() {
  if (is_open()) close(descriptor_);
}

std::optional<std::uint64_t> SharedFile::size() const noexcept {
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return static_cast<std::uint64_t>(status.st_size);
}

bool SharedFile::read(void* bytes, std::size_t count) const noexcept {
  auto* to = static_cast<std::uint8_t*>(bytes);
  while (count > 0) {
    const ssize_t got = ::read(descriptor_, to, count);
    if (got <= 0) return false;
    to += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

void SharedFile::touch() const noexcept { static_cast<void>(futimens(descriptor_, nullptr)); }

FolderLock::FolderLock(const std::filesystem::path& folder) noexcept
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool FolderLock::take() const noexcept { return flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

namespace {

constexpr int kMostNamesTried = 100;
constexpr std::string_view kBesideStart = ".welkin-";
constexpr std::string_view kBesideEnd = ".part";

/// In the same directory, so that renaming is one step; hidden, and no other process's or call's. In containers every
/// run has the same process number, so that the time tells it from what a killed one left.
std::filesystem::path name_beside(const std::filesystem::path& path) {
  static std::atomic<unsigned> count{0};
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  const std::string unique =
      std::to_string(getpid()) + '-' + std::to_string(count++) + '-' + std::to_string(static_cast<std::uint64_t>(now));
  return path.parent_path() / (std::string(kBesideStart) + unique + std::string(kBesideEnd));
}

bool is_name_beside(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return name.size() > kBesideStart.size() + kBesideEnd.size() && name.starts_with(kBesideStart) &&
         name.ends_with(kBesideEnd) &&
         name.find_first_not_of("0123456789-", kBesideStart.size()) == name.size() - kBesideEnd.size();
}

/// Whether the descriptor's file is the one of that name.
bool is_file_of(int descriptor, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

/// The name of a file that has none.
std::string descriptor_path(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

/// Once for each folder that this process writes to.
void tidy_once(const std::filesystem::path& folder) {
  constexpr std::size_t kMostKnown = 64;
  static auto& mutex = *new std::mutex;  // never destroyed: files are written while a program exits too
  static auto& known = *new std::set<std::filesystem::path>;
  {
    const std::scoped_lock lock(mutex);
    if (known.size() == kMostKnown) known.clear();
    if (!known.insert(folder).second) return;
  }
  remove_left_behind(folder);
}

/// The status of what would be replaced.
std::filesystem::file_status require_replaceable(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (status.type() == std::filesystem::file_type::directory) {
    throw file_error(ErrorCode::file_access, path, "is a directory; name a file in it");
  }
  if (std::filesystem::exists(status) && status.type() != std::filesystem::file_type::regular) {
    throw file_error(ErrorCode::file_access, path,
                     "is not a regular file, and would be replaced by one; name another file");
  }
  return status;
}

/// Renaming would replace a link itself, not the file that it leads to.
std::filesystem::path behind_links(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::path target = std::filesystem::canonical(path, failure);
  return failure ? path : target;
}

}  // namespace

void remove_left_behind(const std::filesystem::path& folder) noexcept {
  try {
    std::error_code failure;
    std::filesystem::directory_iterator at(folder, failure);
    for (; !failure && at != std::filesystem::directory_iterator(); at.increment(failure)) {
      if (!is_name_beside(at->path())) continue;
      const int descriptor = open(at->path().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
      if (descriptor < 0) continue;
      // Of a writer that lives it has the lock, or another name (see `open_beside`).
      if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && is_file_of(descriptor, at->path())) unlink(at->path().c_str());
      close(descriptor);
    }
  } catch (const std::exception&) {  // no memory for a name: another time
  }
}

WholeFile::WholeFile(std::filesystem::path path, std::vector<std::byte>* memory, Link link)
    : path_(std::move(path)), memory_(memory) {
  if (memory_ != nullptr) return;
  std::filesystem::file_status replaced;
  if (link == Link::kept) replaced = require_replaceable(path_);
  place_ = link == Link::kept ? behind_links(path_) : path_;
  tidy_once(std::filesystem::absolute(place_).parent_path());
  open_without_name();
  if (descriptor_ < 0) open_beside();
  const int copy = fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);  // for the stream, which closes its own
  if (copy >= 0) stream_ = fdopen(copy, "wb");
  if (stream_ == nullptr) {
    const int reason = errno;
    if (copy >= 0) close(copy);
    discard();
    errno = reason;
    fail("cannot be opened for writing");
  }
  if (std::filesystem::exists(replaced)) {
    // Best effort: a file system without permissions has none to lose.
    static_cast<void>(fchmod(descriptor_, static_cast<mode_t>(replaced.permissions() & std::filesystem::perms::all)));
  }
}

WholeFile::~WholeFile() {
  if (stream_ != nullptr) {
    std::fclose(stream_);
  }
  discard();
}

void WholeFile::discard() noexcept {
  if (!beside_.empty()) unlink(beside_.c_str());
  beside_.clear();
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
}

/// Where the file system has no such files, or the system no names for them, there is no descriptor.
void WholeFile::open_without_name() {
#ifdef O_TMPFILE
  const std::filesystem::path folder = place_.has_parent_path() ? place_.parent_path() : ".";
  descriptor_ = open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return;
  if (access(descriptor_path(descriptor_).c_str(), F_OK) != 0) {
    close(std::exchange(descriptor_, -1));
    return;
  }
  static_cast<void>(flock(descriptor_, LOCK_EX | LOCK_NB));  // for the moment in which it is named beside
#endif
}

void WholeFile::open_beside() {
  for (int tried = 0; descriptor_ < 0 && tried < kMostNamesTried; ++tried) {
    beside_ = name_beside(place_);
    errno = 0;
    descriptor_ = open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
    // Who tidies the folder may have come between, and holds the lock or has removed the file.
    const bool locked = flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
    if (!locked || !is_file_of(descriptor_, beside_)) close(std::exchange(descriptor_, -1));
  }
  if (descriptor_ >= 0) return;
  beside_.clear();
  fail("cannot be written in that directory");
}

void WholeFile::write(const void* bytes, std::size_t count) {
  if (count == 0) {
    return;  // an empty vector's bytes may be at no address, which fwrite may not be given
  }
  errno = 0;
  if (memory_ != nullptr) {
    write_to_memory(bytes, count);
  } else if (std::fwrite(bytes, 1, count, stream_) != count) {
    fail("could not be written");
  }
  position_ += count;
}

void WholeFile::write_to_memory(const void* bytes, std::size_t count) {
  const std::uint64_t end = position_ + count;
  try {
    if (end > gathered_.size()) gathered_.resize(static_cast<std::size_t>(end));
  } catch (const std::exception&) {  // bad_alloc, or longer than any vector may be
    errno = ENOMEM;
    fail("could not be written");
  }
  std::memcpy(gathered_.data() + position_, bytes, count);
}

void WholeFile::seek(std::uint64_t position) {
  errno = 0;
  if (memory_ == nullptr && fseeko(stream_, static_cast<off_t>(position), SEEK_SET) != 0) {
    fail("could not be written");
  }
  position_ = position;
}

void WholeFile::finish(bool to_disk) {
  errno = failure_;
  if (failed_ || (memory_ == nullptr && std::fclose(std::exchange(stream_, nullptr)) != 0)) {
    fail("could not be written");
  }
  // A file system that cannot say so (EINVAL) does not lose what it has.
  if (to_disk && memory_ == nullptr && fdatasync(descriptor_) != 0 && errno != EINVAL) fail("could not be written");
}

/// To a file without one: in its place if that is free, else beside it, because a link replaces nothing.
void WholeFile::give_name() {
  const std::string unnamed = descriptor_path(descriptor_);
  const auto link_to = [&](const std::filesystem::path& name) {
    return linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  };
  bool named = link_to(place_);
  if (named) return;
  for (int tried = 0; !named && errno == EEXIST && tried < kMostNamesTried; ++tried) {
    beside_ = name_beside(place_);
    named = link_to(beside_);
  }
  if (named) return;
  beside_.clear();
  fail("could not be put in its place");
}

void WholeFile::commit() {
  if (memory_ != nullptr) {
    *memory_ = std::move(gathered_);
    return;
  }
  if (beside_.empty()) give_name();
  std::error_code failure;
  if (!beside_.empty()) std::filesystem::rename(beside_, place_, failure);
  if (failure) {
    throw file_error(ErrorCode::file_access, path_,
                     "could not be put in its place: " + failure.message() + "; try another name or directory");
  }
  beside_.clear();
  discard();
}

void WholeFile::fail(const char* what) {
  const int reason = errno;
  failure_ = failed_ ? failure_ : reason;
  failed_ = true;
  const std::string why = reason != 0 ? std::generic_category().message(reason) : "the system does not say why";
  const char* const remedy = memory_ != nullptr ? "; the caller's bytes are as they were, write it to a file"
                                                : "; nothing was left there, try another directory or disk";
  throw file_error(ErrorCode::file_access, path_, std::string(what) + ": " + why + remedy);
}

}  // namespace welkin::platform
