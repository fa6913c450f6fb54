// Faces out of an .env file.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "files/env_manifest.h"
#include "files/rgbd.h"
#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

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
  platform::ByteFile file_;
  std::stop_token stop_;
  RgbdDecoder decoder_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> rgba_;
};

/// An upper bound on what a reader holds for pictures of that size, the libraries' memory included.
[[nodiscard]] std::uint64_t env_reader_bytes(int size, std::uint64_t picture_bytes) noexcept;

/// "level 2, face -Y"
[[nodiscard]] std::string name_of_env_picture(std::size_t index);

// Babylon.js .env files as rows.

/// A file that `is_env`. Faces come in Welkin's axes (x mirrored: Babylon.js's are left-handed) as a vertical strip;
/// each decodes whole. Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_env(platform::ByteFile& file, const ReadOptions& options);

}  // namespace welkin::files
