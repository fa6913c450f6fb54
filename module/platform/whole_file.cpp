// Files that are whole or not there: what all systems have in common.
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

#include "platform/file.h"
#include "platform/pending_file.h"
#include "platform/text.h"

namespace welkin::platform {
namespace {

constexpr std::string_view kBesideStart = ".welkin-";
constexpr std::string_view kBesideEnd = ".part";

bool is_name_beside(const std::filesystem::path& path) {
  const std::string name = utf8(path.filename());
  return name.size() > kBesideStart.size() + kBesideEnd.size() && name.starts_with(kBesideStart) &&
         name.ends_with(kBesideEnd) &&
         name.find_first_not_of("0123456789-", kBesideStart.size()) == name.size() - kBesideEnd.size();
}

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

/// Renaming would replace a link itself, not the file that it leads to.
std::filesystem::path behind_links(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::path target = std::filesystem::canonical(path, failure);
  return failure ? path : target;
}

}  // namespace

// In containers every run has the same process number, so that the time tells it from what a killed one left.
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
  } catch (const std::exception&) {  // no memory for a name: another time
  }
}

WholeFile::WholeFile(std::filesystem::path path, std::vector<std::byte>* memory, Link link)
    : path_(std::move(path)), memory_(memory) {
  if (memory_ != nullptr) return;
  std::filesystem::file_status replaced;
  if (link == Link::kept) replaced = require_replaceable(path_);
  const std::filesystem::path place = reachable(link == Link::kept ? behind_links(path_) : path_);
  tidy_once(std::filesystem::absolute(place).parent_path());
  pending_ = std::make_unique<PendingFile>(place);
  if (!pending_->make()) fail("cannot be written in that directory", pending_->why());
  if (!pending_->open_stream()) fail("cannot be opened for writing", pending_->why());
  if (std::filesystem::exists(replaced)) pending_->set_permissions(replaced.permissions());
}

WholeFile::~WholeFile() = default;

void WholeFile::write(const void* bytes, std::size_t count) {
  if (count == 0) {
    return;  // an empty vector's bytes may be at no address, which fwrite may not be given
  }
  if (memory_ != nullptr) {
    write_to_memory(bytes, count);
  } else if (!pending_->write(bytes, count)) {
    fail("could not be written", pending_->why());
  }
  position_ += count;
}

void WholeFile::write_to_memory(const void* bytes, std::size_t count) {
  const std::uint64_t end = position_ + count;
  try {
    if (end > gathered_.size()) gathered_.resize(static_cast<std::size_t>(end));
  } catch (const std::exception&) {  // bad_alloc, or longer than any vector may be
    fail("could not be written", std::generic_category().message(ENOMEM));
  }
  std::memcpy(gathered_.data() + position_, bytes, count);
}

void WholeFile::seek(std::uint64_t position) {
  if (memory_ == nullptr && !pending_->seek(position)) fail("could not be written", pending_->why());
  position_ = position;
}

void WholeFile::finish(bool to_disk) {
  if (failed_) fail("could not be written", failure_);
  if (memory_ != nullptr) return;
  if (!pending_->close_stream() || (to_disk && !pending_->flush_to_disk())) {
    fail("could not be written", pending_->why());
  }
}

void WholeFile::commit() {
  if (memory_ != nullptr) {
    *memory_ = std::move(gathered_);
    return;
  }
  if (!pending_->put_in_place()) {
    throw file_error(ErrorCode::file_access, path_,
                     "could not be put in its place: " + pending_->why() + "; try another name or directory");
  }
}

void WholeFile::fail(const char* what, const std::string& why) {
  if (!failed_) failure_ = why;
  failed_ = true;
  const char* const remedy = memory_ != nullptr ? "; the caller's bytes are as they were, write it to a file"
                                                : "; nothing was left there, try another directory or disk";
  throw file_error(ErrorCode::file_access, path_, std::string(what) + ": " + why + remedy);
}

}  // namespace welkin::platform
