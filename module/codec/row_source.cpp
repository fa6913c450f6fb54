#include "codec/row_source.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "codec/byte_file.h"
#include "codec/env_manifest.h"
#include "codec/env_row_source.h"
#include "codec/exr_row_source.h"
#include "codec/hdr_row_source.h"
#include "codec/pfm_row_source.h"
#include "codec/png_row_source.h"
#include "codec/six_files_source.h"
#include "codec/texture_layout.h"
#include "codec/texture_row_source.h"

namespace welkin::codec {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::string_view bytes;
  const char* kind;
};

// What people are likely to hand in instead, so that the refusal can name it.
constexpr std::array kOtherKinds{
    Signature{"\xff\xd8\xff"sv, "a JPEG"},
    Signature{"II*\0"sv, "a TIFF"},
    Signature{"MM\0*"sv, "a TIFF"},
    Signature{"RIFF"sv, "a WebP, or another RIFF file"},
};

std::string_view first_bytes(ByteFile& file, std::array<char, 8>& buffer) {
  const std::size_t count = std::min<std::uint64_t>(buffer.size(), file.size());
  file.read(buffer.data(), count);
  file.seek(0);
  return {buffer.data(), count};
}

[[noreturn]] void refuse(const std::filesystem::path& path, std::string_view start) {
  const auto* known = std::find_if(kOtherKinds.begin(), kOtherKinds.end(),
                                   [&](const Signature& other) { return start.starts_with(other.bytes); });
  const std::string found = start.empty()                ? "is empty"
                            : known != kOtherKinds.end() ? std::string("is ") + known->kind
                                                         : "is of no kind that is known here";
  throw file_error(
      ErrorCode::unsupported_file, path,
      found + "; OpenEXR (.exr), Radiance (.hdr), PFM (.pfm), PNG, KTX2, DDS and .env are read: convert it");
}

}  // namespace

std::unique_ptr<RowSource> open_picture(const std::filesystem::path& path, const ReadOptions& options) {
  ByteFile file(path);
  std::array<char, 8> buffer{};
  const std::string_view start = first_bytes(file, buffer);
  if (start.starts_with("\x76\x2f\x31\x01"sv)) {
    return open_exr(file, options);
  }
  if (start.starts_with("PF"sv) || start.starts_with("Pf"sv)) {
    return open_pfm(file, options);
  }
  if (start.starts_with("#?"sv)) {
    return open_hdr(file, options);
  }
  if (start.starts_with("\x89PNG"sv)) {
    return open_png(file, options);
  }
  if (is_texture(file)) {
    return open_texture(file, options);
  }
  if (is_env(file)) {
    return open_env(file, options);
  }
  refuse(path, start);
}

std::unique_ptr<RowSource> open_row_source(const std::filesystem::path& path, const ReadOptions& options) {
  if (options.layout == Layout::six_files) {
    return open_six_files(path, options, "six-files was asked for");
  }
  std::error_code ignored;
  if (options.layout == Layout::automatic && std::filesystem::is_directory(path, ignored)) {
    return open_six_files(path, options, "the directory holds the six faces of one cube");
  }
  std::unique_ptr<RowSource> picture = open_picture(path, options);
  if (picture->info().layout != Layout::six_files) {
    return picture;
  }
  return open_six_files(path, options, picture->info().layout_reason);
}

}  // namespace welkin::codec
