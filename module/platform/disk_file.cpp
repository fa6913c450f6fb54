// Files on a disk: the code that all systems with files share.
#include <atomic>
#include <cerrno>
#include <chrono>
#include <exception>
#include <fstream>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "platform/file.h"
#include "platform/pending_file.h"
#include "platform/text.h"

namespace welkin::platform {
namespace {

// Files that are read.

// Anything but a regular file is refused before it is opened: a pipe would block, and a directory opens and then reads
// nothing.
void require_regular_file(const std::filesystem::path& path) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(reachable(path), failure);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw file_error(ErrorCode::file_access, path, "there is no such file; check the path");
  }
  if (failure) {
    throw file_error(ErrorCode::file_access, path,
                     "cannot be accessed (" + failure.message() + "); check its permissions");
  }
  if (status.type() == std::filesystem::file_type::directory) {
    throw file_error(ErrorCode::file_access, path, "is a directory; name an image in it");
  }
  if (status.type() != std::filesystem::file_type::regular) {
    throw file_error(ErrorCode::file_access, path, "is not a regular file; copy its contents to a file first");
  }
}

class Stream final : public DiskFile {
 public:
  explicit Stream(const std::filesystem::path& path) : path_(path) {
    require_regular_file(path);
    errno = 0;
    stream_.open(reachable(path), std::ios::binary);
    if (!stream_) {
      const std::string reason = errno != 0 ? std::generic_category().message(errno) : "the system does not say why";
      throw file_error(ErrorCode::file_access, path, "cannot be opened (" + reason + "); check its permissions");
    }
    std::error_code failure;
    size_ = std::filesystem::file_size(reachable(path), failure);
    if (failure) {
      throw file_error(ErrorCode::file_access, path,
                       "its size cannot be determined (" + failure.message() + "); check its permissions");
    }
  }

  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }

  void read(std::uint64_t position, void* bytes, std::size_t count) override {
    if (position != position_) stream_.seekg(static_cast<std::streamoff>(position));
    stream_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(count));
    if (!stream_) {
      throw file_error(ErrorCode::file_access, path_,
                       "could not be read at byte " + std::to_string(position) + "; is it being written or moved?");
    }
    position_ = position + count;
  }

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;  // of the stream, which seeks only when a read needs it
};

// Files that are being written: their targets, their temporary names, and their streams.

constexpr std::string_view kBesideStart = ".welkin-";
constexpr std::string_view kBesideEnd = ".part";

bool is_name_beside(const std::filesystem::path& path) {
  const std::string name = utf8(path.filename());
  return name.size() > kBesideStart.size() + kBesideEnd.size() && name.starts_with(kBesideStart) &&
         name.ends_with(kBesideEnd) &&
         name.find_first_not_of("0123456789-", kBesideStart.size()) == name.size() - kBesideEnd.size();
}

/// Removes leftover files, once for each folder that this process writes to.
void tidy_once(const std::filesystem::path& folder) {
  constexpr std::size_t kMaxKnown = 64;
  static auto& mutex = *new std::mutex;  // never destroyed: files are written while a program exits too
  static auto& known = *new std::set<std::filesystem::path>;
  {
    const std::scoped_lock lock(mutex);
    if (known.size() == kMaxKnown) known.clear();
    if (!known.insert(folder).second) return;
  }
  remove_left_behind(folder);
}

/// Returns the status of the file that would be replaced.
std::filesystem::file_status require_replaceable(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(reachable(path), ignored);
  if (status.type() == std::filesystem::file_type::directory) {
    throw file_error(ErrorCode::file_access, path, "is a directory; name a file in it");
  }
  if (std::filesystem::exists(status) && status.type() != std::filesystem::file_type::regular) {
    throw file_error(ErrorCode::file_access, path,
                     "is not a regular file, and would be replaced by one; name another file");
  }
  return status;
}

/// Follows links: renaming would replace a link itself, not the file that it leads to.
std::filesystem::path behind_links(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::path target = std::filesystem::canonical(path, failure);
  return failure ? path : target;
}

}  // namespace

std::unique_ptr<DiskFile> open_disk_file(const std::filesystem::path& path) { return std::make_unique<Stream>(path); }

PendingFile::~PendingFile() {
  if (stream_ != nullptr) std::fclose(stream_);
  discard();
}

bool PendingFile::note_unless(bool succeeded) {
  if (!succeeded) why_ = errno != 0 ? std::generic_category().message(errno) : "the system does not say why";
  return succeeded;
}

bool PendingFile::write(const void* bytes, std::size_t count) {
  errno = 0;
  return note_unless(std::fwrite(bytes, 1, count, stream_) == count);
}

bool PendingFile::close_stream() {
  errno = 0;
  return note_unless(std::fclose(std::exchange(stream_, nullptr)) == 0);
}

// In containers every run has the same process number; the time tells this name from one that a killed run left.
std::filesystem::path name_beside(const std::filesystem::path& path) {
  static std::atomic<unsigned> count{0};
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  const std::string unique = std::to_string(process_number()) + '-' + std::to_string(count++) + '-' +
                             std::to_string(static_cast<std::uint64_t>(now));
  return path.parent_path() / (std::string(kBesideStart) + unique + std::string(kBesideEnd));
}

void remove_left_behind(const std::filesystem::path& folder) noexcept {
  try {
    std::error_code failure;
    std::filesystem::directory_iterator at(reachable(folder), failure);
    for (; !failure && at != std::filesystem::directory_iterator(); at.increment(failure)) {
      if (is_name_beside(at->path())) remove_if_left_behind(at->path());
    }
  } catch (const std::exception&) {  // no memory for a name: removed another time
  }
}

PendingTarget target_of(const std::filesystem::path& path, WholeFile::Link link) {
  const bool kept = link == WholeFile::Link::kept;
  std::filesystem::file_status replaced;
  if (kept) replaced = require_replaceable(path);
  PendingTarget target{reachable(kept ? behind_links(path) : path), std::nullopt};
  tidy_once(std::filesystem::absolute(target.path).parent_path());
  if (std::filesystem::exists(replaced)) target.permissions = replaced.permissions();
  return target;
}

}  // namespace welkin::platform
