// Files that appear as a whole or not at all.
#include <cerrno>
#include <cstring>
#include <exception>
#include <string>
#include <system_error>
#include <utility>

#include "platform/file.h"
#include "platform/pending_file.h"

namespace welkin::platform {
WholeFile::WholeFile(std::filesystem::path path, std::vector<std::byte>* memory, Link link)
    : path_(std::move(path)), memory_(memory) {
  if (memory_ != nullptr) return;
  const PendingTarget target = target_of(path_, link);
  pending_ = std::make_unique<PendingFile>(target.path);
  if (!pending_->make()) fail("cannot be written in that directory", pending_->why());
  if (!pending_->open_stream()) fail("cannot be opened for writing", pending_->why());
  if (target.permissions) pending_->set_permissions(*target.permissions);
}

WholeFile::~WholeFile() = default;

void WholeFile::write(const void* bytes, std::size_t count) {
  if (count == 0) {
    return;  // an empty vector's data may be null, which fwrite may not be given
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
                                                : "; no partial file was left; try another directory or disk";
  throw file_error(ErrorCode::file_access, path_, std::string(what) + ": " + why + remedy);
}

}  // namespace welkin::platform
