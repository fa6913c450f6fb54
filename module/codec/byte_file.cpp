#include "codec/byte_file.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace welkin::codec {
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

ByteFile::ByteFile(const std::filesystem::path& path) : path_(path) {
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
  if (position_ != stream_position_) {
    stream_.seekg(static_cast<std::streamoff>(position_));
  }
  stream_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(count));
  if (!stream_) {
    throw file_error(ErrorCode::file_access, path_,
                     "could not be read at byte " + std::to_string(position_) + "; is it being written or moved?");
  }
  position_ += count;
  stream_position_ = position_;
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

}  // namespace welkin::codec
