#include "codec/exr_attributes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace welkin::codec {
namespace {

// OpenEXR allows 255 bytes for a name; the longest sound header seen was a few megabytes of preview.
constexpr std::size_t kLongestName = 255;
constexpr std::uint64_t kLargestHeader = std::uint64_t{256} << 20U;

struct FixedSize {
  std::string_view type;
  std::uint32_t bytes;
};

// The types that always take the same number of bytes.
constexpr std::array kFixedSizes{
    FixedSize{"box2f", 16},   FixedSize{"box2i", 16},      FixedSize{"chromaticities", 32},
    FixedSize{"double", 8},   FixedSize{"compression", 1}, FixedSize{"deepImageState", 1},
    FixedSize{"envmap", 1},   FixedSize{"float", 4},       FixedSize{"int", 4},
    FixedSize{"keycode", 28}, FixedSize{"lineOrder", 1},   FixedSize{"m33d", 72},
    FixedSize{"m33f", 36},    FixedSize{"m44d", 128},      FixedSize{"m44f", 64},
    FixedSize{"rational", 8}, FixedSize{"tiledesc", 9},    FixedSize{"timecode", 8},
    FixedSize{"v2d", 16},     FixedSize{"v2f", 8},         FixedSize{"v2i", 8},
    FixedSize{"v3d", 24},     FixedSize{"v3f", 12},        FixedSize{"v3i", 12},
};

[[noreturn]] void reject(const ByteFile& file, const std::string& what) {
  throw file_error(ErrorCode::corrupt_file, file.path(), "its OpenEXR header is damaged: " + what);
}

// Little-endian, as everything in OpenEXR.
std::uint32_t read_uint32(ByteFile& file) {
  std::array<unsigned char, 4> bytes{};
  file.read(bytes.data(), bytes.size());
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U |
         static_cast<std::uint32_t>(bytes[2]) << 16U | static_cast<std::uint32_t>(bytes[3]) << 24U;
}

std::string read_name(ByteFile& file, std::uint64_t end) {
  std::string name;
  while (true) {
    char c = 0;
    if (file.position() >= end) {
      reject(file, "a name does not end");
    }
    file.read(&c, 1);
    if (c == 0) {
      return name;
    }
    name += c;
    if (name.size() > kLongestName) {
      reject(file, "a name is longer than " + std::to_string(kLongestName) + " bytes");
    }
  }
}

// Names with 16 bytes of description each, ended by an empty name.
void walk_channels(ByteFile& file, std::uint64_t end) {
  constexpr std::uint64_t kDescription = 16;
  while (!read_name(file, end).empty()) {
    file.seek(file.position() + kDescription);
  }
}

// Strings with their length before each.
void walk_strings(ByteFile& file, std::uint64_t end) {
  while (file.position() < end) {
    const std::uint32_t length = read_uint32(file);
    file.seek(file.position() + length);
  }
}

// Width and height, then four bytes a pixel.
void walk_preview(ByteFile& file) {
  const std::uint64_t width = read_uint32(file);
  const std::uint64_t height = read_uint32(file);
  if (width > kLargestHeader || height > kLargestHeader) {
    reject(file, "its preview is too large");
  }
  file.seek(file.position() + 4 * width * height);
}

// Moves behind the value as OpenEXR will, given the type.
void walk_value(ByteFile& file, const std::string& type, std::uint32_t size) {
  const std::uint64_t end = file.position() + size;
  const auto* fixed = std::find_if(kFixedSizes.begin(), kFixedSizes.end(),
                                   [&](const FixedSize& candidate) { return candidate.type == type; });
  if (fixed != kFixedSizes.end()) {
    file.seek(file.position() + fixed->bytes);
  } else if (type == "chlist") {
    walk_channels(file, end);
  } else if (type == "stringvector") {
    walk_strings(file, end);
  } else if (type == "preview") {
    walk_preview(file);
  } else if (type == "floatvector") {
    file.seek(file.position() + size / 4 * 4);
  } else {
    file.seek(end);
  }
}

}  // namespace

void check_exr_attributes(ByteFile& file) {
  const std::uint64_t limit = std::min(file.size(), file.position() + kLargestHeader);
  for (std::string name = read_name(file, limit); !name.empty(); name = read_name(file, limit)) {
    const std::string type = read_name(file, limit);
    const std::uint32_t size = read_uint32(file);
    const std::string title = "attribute \"" + printable(name) + "\" of type \"" + printable(type) + "\"";
    if (file.position() > limit || size > limit - file.position()) {
      reject(file, title + " claims " + std::to_string(size) + " bytes, which it does not have");
    }
    const std::uint64_t end = file.position() + size;
    walk_value(file, type, size);
    if (file.position() != end) {
      reject(file, title + " claims " + std::to_string(size) + " bytes, which is not what it takes");
    }
  }
}

}  // namespace welkin::codec
