#include "codec/texture_layout.h"

#include <algorithm>
#include <string_view>

#include "image/check_views.h"
#include "welkin/cubemap_chain.h"

namespace welkin::codec {
namespace {

using namespace std::string_view_literals;

std::string_view first_bytes(ByteFile& file, std::array<char, 5>& buffer) {
  file.seek(0);
  const std::size_t count = std::min<std::uint64_t>(buffer.size(), file.size());
  file.read(buffer.data(), count);
  file.seek(0);
  return {buffer.data(), count};
}

bool is_ktx(std::string_view start) { return start.starts_with("\xabKTX "sv); }
bool is_dds(std::string_view start) { return start.starts_with("DDS "sv); }

}  // namespace

const char* name(Supercompression supercompression) noexcept {
  switch (supercompression) {
    case Supercompression::none: return "none";
    case Supercompression::zlib: return "zlib";
    case Supercompression::zstd: return "zstd";
  }
  return "unknown";
}

bool is_texture(ByteFile& file) {
  std::array<char, 5> buffer{};
  const std::string_view start = first_bytes(file, buffer);
  return is_ktx(start) || is_dds(start);
}

TextureLayout read_texture_layout(ByteFile& file) {
  std::array<char, 5> buffer{};
  const std::string_view start = first_bytes(file, buffer);
  if (is_ktx(start)) return read_ktx2_layout(file);
  if (is_dds(start)) return read_dds_layout(file);
  throw file_error(ErrorCode::unsupported_file, file.path(), "is neither a KTX2 nor a DDS texture by its first bytes");
}

void check_cubemap_sizes(const ByteFile& file, std::uint64_t width, std::uint64_t height, std::uint64_t levels) {
  const auto refuse = [&file](ErrorCode code, const std::string& message) {
    throw file_error(code, file.path(), message);
  };
  const std::string shape = std::to_string(width) + " x " + std::to_string(height);
  if (width != height || width < 1) {
    refuse(ErrorCode::corrupt_file, "its faces are " + shape + " texels; a cubemap's are square, from 1 x 1 up");
  }
  if (width > image::kLargestFace) {
    refuse(ErrorCode::unsupported_file,
           "its faces are " + shape + " texels; reduce them to " + std::to_string(image::kLargestFace) + " or fewer");
  }
  const int most = full_chain_levels(static_cast<int>(width));
  if (levels < 1 || levels > static_cast<std::uint64_t>(most)) {
    refuse(ErrorCode::corrupt_file, "says that it has " + std::to_string(levels) + " levels; from " + shape +
                                        " texels down there can be 1 to " + std::to_string(most));
  }
}

}  // namespace welkin::codec
