#include "platform/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <exception>
#include <string>
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

Error file_error(ErrorCode code, const std::filesystem::path& path, const std::string& message) {
  return {code, path.string() + ": " + message};
}

std::string printable(const std::string& text) {
  constexpr std::size_t kLongest = 200;
  std::string result = text.substr(0, kLongest);
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text.size() > kLongest ? result + "..." : result;
}

SharedFile::SharedFile(const std::filesystem::path& path) noexcept
    : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}

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

namespace {

constexpr int kMostNamesTried = 100;

/// In the same directory, so that renaming is one step; hidden, and no other process's or call's.
std::filesystem::path name_beside(const std::filesystem::path& path) {
  static std::atomic<unsigned> count{0};
  const std::string unique = std::to_string(getpid()) + "-" + std::to_string(count++);
  return path.parent_path() / (".welkin-" + unique + ".part");
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

WholeFile::WholeFile(std::filesystem::path path, std::vector<std::byte>* memory)
    : path_(std::move(path)), memory_(memory) {
  if (memory_ != nullptr) return;
  const std::filesystem::file_status replaced = require_replaceable(path_);
  place_ = behind_links(path_);
  int handle = -1;
  for (int tried = 0; handle < 0 && tried < kMostNamesTried; ++tried) {
    beside_ = name_beside(place_);
    errno = 0;
    handle = open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (handle < 0 && errno != EEXIST) break;
  }
  if (handle < 0) {
    fail("cannot be written in that directory");
  }
  stream_ = fdopen(handle, "wb");
  if (stream_ == nullptr) {
    close(handle);
    unlink(beside_.c_str());
    fail("cannot be opened for writing");
  }
  if (std::filesystem::exists(replaced)) {
    // Best effort: a file system without permissions has none to lose.
    static_cast<void>(fchmod(handle, static_cast<mode_t>(replaced.permissions() & std::filesystem::perms::all)));
  }
}

WholeFile::~WholeFile() {
  if (stream_ != nullptr) {
    std::fclose(stream_);
  }
  if (!beside_.empty()) {
    unlink(beside_.c_str());
  }
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
    if (end > gathered_.size()) gathered_.resize(end);
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

void WholeFile::finish() {
  errno = failure_;
  if (failed_ || (memory_ == nullptr && std::fclose(std::exchange(stream_, nullptr)) != 0)) {
    fail("could not be written");
  }
}

void WholeFile::commit() {
  if (memory_ != nullptr) {
    *memory_ = std::move(gathered_);
    return;
  }
  std::error_code failure;
  std::filesystem::rename(beside_, place_, failure);
  if (failure) {
    throw file_error(ErrorCode::file_access, path_,
                     "could not be put in its place: " + failure.message() + "; try another name or directory");
  }
  beside_.clear();
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
