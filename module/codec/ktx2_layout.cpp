// The header of a KTX2 file.
#include <algorithm>
#include <cstring>
#include <limits>

#include "codec/ktx2_format.h"
#include "codec/little_endian.h"
#include "codec/supercompression.h"
#include "codec/texture_layout.h"

namespace welkin::codec {
namespace {

constexpr std::uint32_t kMostMetadataBytes = 1U << 20U;

struct Header {
  std::uint32_t format, type_size, width, height, depth, layers, faces, levels, scheme;
  std::uint32_t descriptor_offset, descriptor_bytes, metadata_offset, metadata_bytes;
};

[[noreturn]] void refuse(const ByteFile& file, ErrorCode code, const std::string& message) {
  throw file_error(code, file.path(), message);
}

Header read_header(ByteFile& file) {
  std::array<std::uint8_t, kKtx2HeaderBytes> bytes{};
  const auto known = static_cast<std::size_t>(std::min<std::uint64_t>(kKtx2Identifier.size(), file.size()));
  file.read(bytes.data(), known);
  if (std::memcmp(bytes.data(), kKtx2Identifier.data(), known) != 0) {
    refuse(file, ErrorCode::unsupported_file, "is a KTX texture, but not of version 2.0; convert it (ktx2ktx2)");
  }
  file.read(bytes.data() + known, bytes.size() - known);
  const auto field = [&bytes](std::size_t index) {
    return read_little_endian<std::uint32_t>(bytes.data() + kKtx2Identifier.size() + 4 * index);
  };
  return {field(0), field(1), field(2), field(3),  field(4),  field(5), field(6),
          field(7), field(8), field(9), field(10), field(11), field(12)};
}

void check_kind(const ByteFile& file, const Header& header) {
  if (header.faces != 6) {
    refuse(file, ErrorCode::unsupported_file,
           "has " + std::to_string(header.faces) + (header.faces == 1 ? " face" : " faces") +
               "; cubemaps, with six, are read");
  }
  if (header.depth > 1 || header.layers > 1) {
    refuse(file, ErrorCode::unsupported_file, "is a volume or an array of cubemaps; save one cubemap alone");
  }
  if (!kind_of_vulkan_format(header.format)) {
    refuse(file, ErrorCode::unsupported_file,
           "its VkFormat " + std::to_string(header.format) +
               " is not read; rgba16f, rgba32f, b10g11r11, e5b9g9r9 and rgba8 (unorm, srgb) are");
  }
  if (!supercompression_of_ktx2(header.scheme)) {
    refuse(file, ErrorCode::unsupported_file,
           "its supercompression scheme " + std::to_string(header.scheme) +
               " is not read; none, Zstandard and ZLIB are: convert it");
  }
  const std::uint32_t type_size = ktx2_type_size(*kind_of_vulkan_format(header.format));
  if (header.type_size != type_size) {
    refuse(file, ErrorCode::corrupt_file,
           "its type size is " + std::to_string(header.type_size) + "; its format's is " + std::to_string(type_size));
  }
}

void require_inside(const ByteFile& file, const char* what, std::uint64_t offset, std::uint64_t bytes) {
  if (offset > file.size() || bytes > file.size() - offset) {
    refuse(file, ErrorCode::corrupt_file,
           std::string("ends too early: its ") + what + " has " + std::to_string(bytes) + " bytes at " +
               std::to_string(offset) + ", the file " + std::to_string(file.size()) + "; fetch or export it again");
  }
}

TextureLayout::Level read_level(const ByteFile& file, const TextureLayout& layout, int level,
                                const std::uint8_t* index) {
  const auto offset = read_little_endian<std::uint64_t>(index);
  const auto bytes = read_little_endian<std::uint64_t>(index + 8);
  const auto unpacked = read_little_endian<std::uint64_t>(index + 16);
  const std::string what = "level " + std::to_string(level);
  require_inside(file, what.c_str(), offset, bytes);
  const bool packed = layout.supercompression != Supercompression::none;
  const std::uint64_t wanted = level_bytes(layout.kind, layout.level_size(level));
  if (unpacked != wanted || (!packed && bytes != wanted)) {
    refuse(file, ErrorCode::corrupt_file,
           "its " + what + " has " + std::to_string(packed ? unpacked : bytes) + " bytes; its size and format take " +
               std::to_string(wanted));
  }
  if (packed && most_unpacked(layout.supercompression, bytes) < wanted) {
    refuse(file, ErrorCode::corrupt_file,
           "its " + what + " has " + std::to_string(bytes) + " packed bytes, which cannot stand for " +
               std::to_string(wanted));
  }
  TextureLayout::Level found;
  found.first_byte = offset;
  found.packed_bytes = bytes;
  for (std::size_t face = 0; !packed && face < 6; ++face) found.faces[face] = offset + face * (wanted / 6);
  return found;
}

/// Keys with their values; a text's closing zero is left out. Entries after one that makes no sense are an error.
std::map<std::string, std::string> read_metadata(ByteFile& file, const Header& header) {
  require_inside(file, "key/value data", header.metadata_offset, header.metadata_bytes);
  if (header.metadata_bytes > kMostMetadataBytes) {
    refuse(file, ErrorCode::limit_exceeded,
           "has " + std::to_string(header.metadata_bytes) + " bytes of key/value data, above the limit of " +
               std::to_string(kMostMetadataBytes) + "; save it without");
  }
  std::vector<char> bytes(header.metadata_bytes);
  file.seek(header.metadata_offset);
  file.read(bytes.data(), bytes.size());
  std::map<std::string, std::string> metadata;
  for (std::size_t place = 0; place + 4 <= bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + place, sizeof length);
    place += sizeof length;
    if (length > bytes.size() - place) {
      refuse(file, ErrorCode::corrupt_file, "its key/value data ends inside an entry");
    }
    const std::string entry(bytes.data() + place, length);
    const std::size_t end_of_key = entry.find('\0');
    if (end_of_key == std::string::npos) {
      refuse(file, ErrorCode::corrupt_file, "its key/value data has a key without an end");
    }
    std::string value = entry.substr(end_of_key + 1);
    if (!value.empty() && value.back() == '\0') value.pop_back();
    metadata[entry.substr(0, end_of_key)] = std::move(value);
    place += (std::size_t{length} + 3) / 4 * 4;
  }
  return metadata;
}

}  // namespace

TextureLayout read_ktx2_layout(ByteFile& file) {
  const Header header = read_header(file);
  check_kind(file, header);
  const std::uint32_t levels = std::max(header.levels, 1U);  // 0: one, and whoever loads it makes the others
  check_cubemap_sizes(file, header.width, header.height, levels);

  TextureLayout layout;
  layout.container = "KTX2";
  layout.kind = *kind_of_vulkan_format(header.format);
  layout.supercompression = *supercompression_of_ktx2(header.scheme);
  layout.size = static_cast<int>(header.width);
  std::vector<std::uint8_t> index(kKtx2LevelIndexBytes * levels);
  file.read(index.data(), index.size());
  for (std::uint32_t level = 0; level < levels; ++level) {
    layout.levels.push_back(
        read_level(file, layout, static_cast<int>(level), index.data() + kKtx2LevelIndexBytes * level));
  }
  require_inside(file, "data format descriptor", header.descriptor_offset, header.descriptor_bytes);
  layout.has_metadata = true;
  layout.metadata = read_metadata(file, header);
  return layout;
}

}  // namespace welkin::codec
