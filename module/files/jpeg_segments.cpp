#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include "files/jpeg.h"

namespace welkin::files {
namespace {

using namespace std::string_view_literals;

// Marker codes, behind a byte of 0xFF. (T.81, table B.1.)
constexpr unsigned kStartOfImage = 0xD8, kEndOfImage = 0xD9, kStartOfScan = 0xDA, kTemporary = 0x01;
constexpr unsigned kApplication1 = 0xE1, kApplication2 = 0xE2;

bool is_restart(unsigned code) { return code >= 0xD0 && code <= 0xD7; }

// Start of a frame, of whatever process: but for Huffman tables (C4), an extension (C8) and arithmetic conditions (CC).
bool is_frame(unsigned code) { return code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC; }
bool is_progressive(unsigned code) { return code == 0xC2 || code == 0xC6 || code == 0xCA || code == 0xCE; }

/// A file's bytes, one after the other, through a buffer.
class Bytes {
 public:
  Bytes(platform::ByteFile& file, std::uint64_t position) : file_(&file), begin_(position) {}

  [[nodiscard]] std::uint64_t position() const noexcept { return begin_ + used_; }
  [[nodiscard]] bool at_end() { return used_ == count_ && !fill(); }

  /// The next byte. Throws as `ByteFile::read` at the file's end.
  unsigned next() {
    if (at_end()) damaged("ends too early");
    return static_cast<unsigned char>(buffer_[used_++]);
  }

  unsigned next_two() {
    const unsigned high = next();
    return high << 8U | next();
  }

  [[noreturn]] void damaged(const std::string& what) const {
    throw platform::file_error(
        ErrorCode::corrupt_file, file_->path(),
        "is a damaged JPEG: " + what + " at byte " + std::to_string(position()) + "; fetch or export it again");
  }

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_->path(); }

 private:
  bool fill() {
    begin_ += count_;
    used_ = 0;
    count_ = begin_ < file_->size() ? std::min<std::uint64_t>(buffer_.size(), file_->size() - begin_) : 0;
    file_->seek(begin_);
    file_->read(buffer_.data(), count_);
    return count_ > 0;
  }

  platform::ByteFile* file_;
  std::uint64_t begin_;
  std::size_t used_ = 0, count_ = 0;
  std::array<char, 16384> buffer_{};
};

std::uint32_t big_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8U | bytes[at + k];
  return value;
}

/// The primaries of an ICC profile that has a colour for each: tags rXYZ, gXYZ and bXYZ, adapted to D50, which together
/// make that white. (ICC.1:2010, 7.2 to 7.3, 9.2.)
std::optional<Chromaticities> primaries_of_profile(std::span<const std::uint8_t> profile) {
  constexpr std::size_t kHeader = 128, kEntry = 12, kMaxTags = 100;
  if (profile.size() < kHeader + 4) return std::nullopt;
  const std::size_t tags = std::min<std::size_t>(big_endian(profile, kHeader), kMaxTags);
  std::array<std::optional<glm::dvec3>, 3> colours;
  for (std::size_t tag = 0; tag < tags; ++tag) {
    const std::size_t entry = kHeader + 4 + kEntry * tag;
    if (entry + kEntry > profile.size()) return std::nullopt;
    constexpr std::array kNames{0x7258595AU, 0x6758595AU, 0x6258595AU};  // "rXYZ", "gXYZ", "bXYZ"
    for (std::size_t channel = 0; channel < 3; ++channel) {
      if (big_endian(profile, entry) != kNames[channel]) continue;
      const std::size_t offset = big_endian(profile, entry + 4);
      if (offset > profile.size() || profile.size() - offset < 20) return std::nullopt;
      glm::dvec3 colour;
      for (int axis = 0; axis < 3; ++axis) {  // s15Fixed16Number
        const auto bits = big_endian(profile, offset + 8 + 4 * static_cast<std::size_t>(axis));
        colour[axis] = (bits >= 0x80000000U ? bits - 4294967296.0 : static_cast<double>(bits)) / 65536.0;
      }
      colours[channel] = colour;
    }
  }
  if (!colours[0] || !colours[1] || !colours[2]) return std::nullopt;
  const auto xy = [](const glm::dvec3& colour) { return glm::dvec2(colour) / (colour.x + colour.y + colour.z); };
  return Chromaticities{xy(*colours[0]), xy(*colours[1]), xy(*colours[2]), xy(*colours[0] + *colours[1] + *colours[2])};
}

/// sRGB's, as its profiles have them: adapted to D50 by Bradford's transform. (IEC 61966-2-1; ICC's own sRGB profile.)
constexpr Chromaticities kAdaptedSrgb{{0.6484, 0.3309}, {0.3212, 0.5978}, {0.1559, 0.0660}, {0.3457, 0.3585}};

void read_profile(JpegSegments& picture, std::span<const std::uint8_t> segment) {
  // After the name, which part this is, and of how many. Profiles of several parts are tables, not primaries.
  const std::optional<Chromaticities> found =
      segment.size() > 2 && segment[1] == 1 ? primaries_of_profile(segment.subspan(2)) : std::nullopt;
  picture.has_other_profile = !found;
  if (found && !nearly_same(*found, kAdaptedSrgb)) picture.primaries = found;
}

/// The bytes after a segment's name, which ends with a zero; nothing if the name is another.
std::optional<std::span<const std::uint8_t>> named(std::span<const std::uint8_t> segment, std::string_view name) {
  if (segment.size() < name.size() ||
      !std::equal(name.begin(), name.end(), segment.begin(),
                  [](char a, std::uint8_t b) { return static_cast<unsigned char>(a) == b; })) {
    return std::nullopt;
  }
  return segment.subspan(name.size());
}

void read_application(JpegSegments& picture, unsigned code, const std::vector<std::uint8_t>& segment,
                      const std::filesystem::path& path) {
  if (code == kApplication1) {
    const auto packet = named(segment, "http://ns.adobe.com/xap/1.0/\0"sv);
    if (!packet || (picture.gain_map && picture.gain_map->by_iso)) return;
    const std::string text(packet->begin(), packet->end());
    if (const std::optional<GainMap> map = gain_map_from_xmp(text, path)) picture.gain_map = map;
  } else if (const auto profile = named(segment, "ICC_PROFILE\0"sv)) {
    read_profile(picture, *profile);
  } else if (const auto numbers = named(segment, "urn:iso:std:iso:ts:21496:-1\0"sv)) {
    if (const std::optional<GainMap> map = gain_map_from_iso(*numbers, path)) picture.gain_map = map;
  }
}

void read_frame(JpegSegments& picture, unsigned code, const std::vector<std::uint8_t>& segment, const Bytes& bytes) {
  if (segment.size() < 6) bytes.damaged("a frame's header is too short");
  picture.bits = segment[0];
  picture.height = segment[1] << 8U | segment[2];
  picture.width = segment[3] << 8U | segment[4];
  picture.components = segment[5];
  picture.buffered = is_progressive(code);
}

/// Passes over the coded samples of a scan to the marker behind them, and returns its code.
unsigned marker_behind_scan(Bytes& bytes) {
  while (true) {
    unsigned code = bytes.next();
    if (code != 0xFF) continue;
    while (code == 0xFF) code = bytes.next();
    if (code != 0x00 && !is_restart(code)) return code;
  }
}

unsigned next_marker(Bytes& bytes) {
  unsigned code = bytes.next();
  if (code != 0xFF) bytes.damaged("a marker is missing");
  while (code == 0xFF) code = bytes.next();
  return code;
}

/// The picture that begins at a place; reads it to its end.
JpegSegments read_picture(platform::ByteFile& file, std::uint64_t begin) {
  JpegSegments picture;
  picture.begin = begin;
  Bytes bytes(file, begin + 2);
  int scans = 0, components_in_scan = 0;
  for (unsigned code = next_marker(bytes); code != kEndOfImage;) {
    if (code == kTemporary || is_restart(code)) {
      code = next_marker(bytes);
      continue;
    }
    const unsigned length = bytes.next_two();
    if (code == kStartOfImage || length < 2) bytes.damaged("a segment has no length");
    std::vector<std::uint8_t> segment(length - 2);
    for (std::uint8_t& byte : segment) byte = static_cast<std::uint8_t>(bytes.next());
    if (is_frame(code)) read_frame(picture, code, segment, bytes);
    if (code == kApplication1 || code == kApplication2) read_application(picture, code, segment, bytes.path());
    if (code == kStartOfScan) {
      ++scans;
      components_in_scan = segment.empty() ? 0 : segment[0];
      code = marker_behind_scan(bytes);
    } else {
      code = next_marker(bytes);
    }
  }
  picture.end = bytes.position();
  picture.buffered = picture.buffered || scans > 1 || components_in_scan < picture.components;
  if (scans == 0 || picture.width == 0 || picture.height == 0) bytes.damaged("it has no image");
  if (picture.bits != 8 || (picture.components != 1 && picture.components != 3)) {
    throw platform::file_error(ErrorCode::unsupported_file, bytes.path(),
                               "is a JPEG of " + std::to_string(picture.components) + " components of " +
                                   std::to_string(picture.bits) + " bits; 1 or 3 of 8 bits are read");
  }
  return picture;
}

}  // namespace

std::vector<JpegSegments> jpeg_pictures(platform::ByteFile& file) {
  std::vector<JpegSegments> pictures{read_picture(file, 0)};
  // Cameras pad between pictures, and keep previews, depths and films behind them.
  constexpr std::size_t kMaxImages = 16;
  Bytes bytes(file, pictures[0].end);
  for (unsigned seen = 0;
       pictures.size() < kMaxImages && (pictures.size() == 1 || !pictures.back().gain_map) && !bytes.at_end();) {
    seen = (seen << 8U | bytes.next()) & 0xFFFFFFU;
    if (seen != 0xFFD8FF) continue;
    pictures.push_back(read_picture(file, bytes.position() - 3));
    bytes = Bytes(file, pictures.back().end);
    seen = 0;
  }
  return pictures;
}

}  // namespace welkin::files
