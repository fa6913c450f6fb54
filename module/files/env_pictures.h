// The small pictures inside an .env file: RGBA of 8 bits, in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "welkin/error.h"

namespace welkin::files {

/// A picture as it stands in a file, of which messages speak as `what`. It must be `size` x `size` texels.
struct EnvPictureBytes {
  const std::vector<std::uint8_t>& bytes;
  int size;
  const std::filesystem::path& path;
  const std::string& what;

  /// Throws `Error` naming the file and the picture.
  [[noreturn]] void refuse(ErrorCode code, const std::string& message) const;
  /// Throws `Error` (corrupt_file) if a picture of these edges is another one than the level's.
  void require_size(std::uint64_t width, std::uint64_t height) const;
};

/// A PNG of `size` x `size` texels, rows as they are given, without any word on colours: they are numbers, and no
/// viewer is to turn them. `stop` is looked at before each row. Throws `Error` (cancelled), `std::bad_alloc`.
[[nodiscard]] std::vector<std::uint8_t> encode_png_rgba(const std::vector<std::uint8_t>& rgba, int size,
                                                        const std::stop_token& stop = {});

/// Decodes a PNG or a WebP, told by its first bytes, to 4 x size x size bytes. `stop` is looked at before each row of a
/// PNG. Throws `Error`: corrupt_file, unsupported_file, cancelled.
void decode_rgba(const EnvPictureBytes& picture, std::uint8_t* rgba, const std::stop_token& stop = {});

// One function a library; a build can leave out either (codecs.h).
void decode_png_rgba(const EnvPictureBytes& picture, std::uint8_t* rgba, const std::stop_token& stop);
void decode_webp_rgba(const EnvPictureBytes& picture, std::uint8_t* rgba);

}  // namespace welkin::files
