#include "files/env_pictures.h"

#include <cstring>

#include "platform/file.h"

namespace welkin::files {

void EnvPictureBytes::refuse(ErrorCode code, const std::string& message) const {
  throw platform::file_error(code, path, what + " " + message);
}

void EnvPictureBytes::require_size(std::uint64_t width, std::uint64_t height) const {
  const auto wanted = static_cast<std::uint64_t>(size);
  if (width == wanted && height == wanted) return;
  refuse(ErrorCode::corrupt_file, "is " + std::to_string(width) + " x " + std::to_string(height) +
                                      " texels; its level has " + std::to_string(size) + " x " + std::to_string(size));
}

void decode_rgba(const EnvPictureBytes& picture, std::uint8_t* rgba, const std::stop_token& stop) {
  const std::vector<std::uint8_t>& bytes = picture.bytes;
  if (bytes.size() >= 8 && std::memcmp(bytes.data(), "\x89PNG", 4) == 0) {
    decode_png_rgba(picture, rgba, stop);
  } else if (bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
             std::memcmp(bytes.data() + 8, "WEBP", 4) == 0) {
    decode_webp_rgba(picture, rgba);
  } else {
    picture.refuse(ErrorCode::unsupported_file, "is neither a PNG nor a WebP by its first bytes; fetch the file again");
  }
}

}  // namespace welkin::files
