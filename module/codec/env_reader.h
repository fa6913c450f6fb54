// Faces out of an .env file.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "codec/env_manifest.h"
#include "codec/rgbd.h"

namespace welkin::codec {

/// Each thread has its own.
class EnvReader {
 public:
  /// `stop` is looked at while a picture is decoded.
  explicit EnvReader(const std::filesystem::path& path, std::stop_token stop = {})
      : file_(path), stop_(std::move(stop)) {}

  /// A picture of `size` x `size` texels to packed RGB floats, row 0 on top (they are stored bottom row first). `what`
  /// names it in messages. Throws `Error`: corrupt_file, unsupported_file, file_access, cancelled.
  void read(const EnvPicture& picture, int size, const std::string& what, float* rgb);

 private:
  ByteFile file_;
  std::stop_token stop_;
  RgbdDecoder decoder_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> rgba_;
};

/// An upper bound on what a reader holds for pictures of that size, the libraries' memory included.
[[nodiscard]] std::uint64_t env_reader_bytes(int size, std::uint64_t picture_bytes) noexcept;

/// "level 2, face -Y"
[[nodiscard]] std::string name_of_env_picture(std::size_t index);

}  // namespace welkin::codec
