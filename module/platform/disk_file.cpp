// Files that are read from a disk.
#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>

#include "platform/file.h"

namespace welkin::platform {
namespace {

// Anything but a regular file is refused before it is opened: a pipe would block, a directory opens and then
// reads nothing.
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
  std::uint64_t position_ = 0;  // where the stream stands; it is moved only when a read needs it
};

}  // namespace

std::unique_ptr<DiskFile> open_disk_file(const std::filesystem::path& path) { return std::make_unique<Stream>(path); }

}  // namespace welkin::platform
