// Markers of a JPEG that describe its images and their gain maps.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "files/jpeg.h"
#include "platform/file.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

using namespace std::string_view_literals;

// Gain maps.

// More stops than any image has; a larger value is an error.
constexpr double kMaximumStops = 64.0;

[[noreturn]] void damaged(const std::filesystem::path& path, const std::string& what) {
  throw platform::file_error(ErrorCode::corrupt_file, path, "has a damaged gain map: " + what + "; export it again");
}

void check(const GainMap& map, const std::filesystem::path& path) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const auto within = [&](double value, double most) { return std::isfinite(value) && std::abs(value) <= most; };
    if (!within(map.minimum[channel], kMaximumStops) || !within(map.maximum[channel], kMaximumStops)) {
      damaged(path, "its gains are " + platform::number_text(map.minimum[channel]) + " to " +
                        platform::number_text(map.maximum[channel]) + " stops");
    }
    if (map.minimum[channel] > map.maximum[channel]) damaged(path, "its minimum is above its maximum");
    if (!(map.gamma[channel] >= 1.0 / 64 && map.gamma[channel] <= 64.0)) {
      damaged(path, "its gamma is " + platform::number_text(map.gamma[channel]));
    }
    if (!within(map.base_offset[channel], 1.0) || !within(map.alternate_offset[channel], 1.0)) {
      damaged(path, "an offset is no number from -1 to 1");
    }
  }
}

// XMP, the part that gain maps use: a property is an attribute, name="1.5", or an element with one value or a list of
// them, <name>1.5</name> or <name><rdf:Seq><rdf:li>1.5</rdf:li>...</rdf:Seq></name>. (XMP specification, part 1, 7.)

bool is_space(char letter) { return letter == ' ' || letter == '\t' || letter == '\n' || letter == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// Returns the prefix that a packet gives a namespace, xmlns:prefix="uri"; empty if the packet does not use it.
std::string prefix_of(std::string_view packet, std::string_view uri) {
  const std::size_t at = packet.find(uri);
  if (at == std::string_view::npos || at < 3) return {};
  const std::string_view before = trimmed(packet.substr(0, at - 1));  // without the quote
  if (before.empty() || before.back() != '=') return {};
  const std::string_view name = trimmed(before.substr(0, before.size() - 1));
  const std::size_t colon = name.rfind("xmlns:"sv);
  return colon == std::string_view::npos ? std::string() : std::string(name.substr(colon + 6));
}

/// Returns the texts of a property: none, one, or those of its list.
std::vector<std::string_view> texts_of(std::string_view packet, const std::string& name) {
  for (std::size_t at = packet.find(name); at != std::string_view::npos; at = packet.find(name, at + 1)) {
    const bool opens = at > 0 && packet[at - 1] == '<';
    if (at == 0 || !(opens || is_space(packet[at - 1]))) continue;
    const std::string_view rest = packet.substr(at + name.size());
    if (const std::string_view after = trimmed(rest); !opens && after.starts_with('=')) {
      const std::string_view value = trimmed(after.substr(1));
      const std::size_t end = value.empty() ? std::string_view::npos : value.find(value.front(), 1);
      if (end == std::string_view::npos) return {};
      return {trimmed(value.substr(1, end - 1))};
    }
    if (!opens || !rest.starts_with('>')) continue;
    std::string_view body = rest.substr(1, rest.find("</" + name) - 1);
    if (body.find('<') == std::string_view::npos) return {trimmed(body)};
    std::vector<std::string_view> texts;
    for (std::size_t item = body.find("<rdf:li>"sv); item != std::string_view::npos; item = body.find("<rdf:li>"sv)) {
      body.remove_prefix(item + 8);
      texts.push_back(trimmed(body.substr(0, body.find('<'))));
    }
    return texts;
  }
  return {};
}

class XmpReader {
 public:
  XmpReader(std::string_view packet, std::string prefix, const std::filesystem::path& path)
      : packet_(packet), prefix_(std::move(prefix)), path_(path) {}

  [[nodiscard]] bool has(const char* name) const { return !texts_of(packet_, prefix_ + ":" + name).empty(); }

  [[nodiscard]] bool is_true(const char* name) const {
    const std::vector<std::string_view> texts = texts_of(packet_, prefix_ + ":" + name);
    return !texts.empty() && (texts[0] == "True"sv || texts[0] == "true"sv);
  }

  /// Reads one value for all channels, or one per channel; if there is none, `values` is unchanged.
  void read(const char* name, std::array<double, 3>& values) const {
    const std::vector<std::string_view> texts = texts_of(packet_, prefix_ + ":" + name);
    if (texts.empty()) return;
    if (texts.size() != 1 && texts.size() != 3) {
      damaged(path_, std::string(name) + " has " + std::to_string(texts.size()) + " values, not 1 or 3");
    }
    for (std::size_t channel = 0; channel < 3; ++channel) {
      values[channel] = number(texts[texts.size() == 1 ? 0 : channel], name);
    }
  }

 private:
  [[nodiscard]] double number(std::string_view text, const char* name) const {
    double value = 0.0;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, failure] = platform::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end != text.data() + text.size()) {
      damaged(path_,
              std::string(name) + " is \"" + platform::printable(std::string(text.substr(0, 40))) + "\", no number");
    }
    return value;
  }

  std::string_view packet_;
  std::string prefix_;
  const std::filesystem::path& path_;
};

/// Reads big-endian numbers, one after the other. (ISO 21496-1:2025, annex C.2.)
class IsoReader {
 public:
  IsoReader(std::span<const std::uint8_t> bytes, const std::filesystem::path& path) : bytes_(bytes), path_(path) {}

  std::uint32_t unsigned_number(std::size_t count) {
    if (bytes_.size() < count) damaged(path_, "its ISO 21496-1 segment ends too early");
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < count; ++k) value = value << 8U | bytes_[k];
    bytes_ = bytes_.subspan(count);
    return value;
  }

  /// Reads a fraction of two numbers of 4 bytes; `denominator` is 0 where each has its own.
  double fraction(bool is_signed, std::uint32_t denominator) {
    const std::uint32_t numerator = unsigned_number(4);
    const std::uint32_t below = denominator != 0 ? denominator : unsigned_number(4);
    if (below == 0) damaged(path_, "a fraction is divided by zero");
    // Two's complement, within defined behaviour.
    const double value = is_signed && numerator >= 0x80000000U ? static_cast<double>(numerator) - 4294967296.0
                                                               : static_cast<double>(numerator);
    return value / static_cast<double>(below);
  }

  [[nodiscard]] bool empty() const noexcept { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  const std::filesystem::path& path_;
};

// Bits of the segment's flags.
constexpr std::uint32_t kEachChannel = 0x80;
constexpr std::uint32_t kCommonDenominator = 0x08;

/// Reads the XMP packet of a gain map's JPEG. Returns nothing if the packet is about other things. Throws `Error`
/// (corrupt_file) for numbers that are missing, invalid, or out of range.
std::optional<GainMap> gain_map_from_xmp(std::string_view packet, const std::filesystem::path& path) {
  std::string prefix = prefix_of(packet, "http://ns.adobe.com/hdr-gain-map/1.0/"sv);
  if (prefix.empty()) return std::nullopt;
  const XmpReader reader(packet, std::move(prefix), path);
  if (!reader.has("GainMapMax")) return std::nullopt;  // the base image's, which only states the version
  GainMap map;
  reader.read("GainMapMin", map.minimum);
  reader.read("GainMapMax", map.maximum);
  reader.read("Gamma", map.gamma);
  reader.read("OffsetSDR", map.base_offset);
  reader.read("OffsetHDR", map.alternate_offset);
  map.from_base = !reader.is_true("BaseRenditionIsHDR");
  check(map, path);
  return map;
}

/// Reads the bytes of ISO 21496-1's segment, after its name. Returns nothing if they only hold a version, as in the
/// base image. Throws `Error`: corrupt_file as above, unsupported_file for a later version.
std::optional<GainMap> gain_map_from_iso(std::span<const std::uint8_t> bytes, const std::filesystem::path& path) {
  IsoReader reader(bytes, path);
  const std::uint32_t minimum_version = reader.unsigned_number(2);
  (void)reader.unsigned_number(2);  // the writer's version
  if (minimum_version != 0) {
    throw platform::file_error(ErrorCode::unsupported_file, path,
                               "has a gain map of ISO 21496-1 version " + std::to_string(minimum_version) +
                                   ", and version 0 is read; export it as Ultra HDR");
  }
  if (reader.empty()) return std::nullopt;
  const std::uint32_t flags = reader.unsigned_number(1);
  const std::uint32_t denominator = (flags & kCommonDenominator) != 0 ? reader.unsigned_number(4) : 0;
  if ((flags & kCommonDenominator) != 0 && denominator == 0) damaged(path, "a fraction is divided by zero");
  const double base_headroom = reader.fraction(false, denominator);
  const double alternate_headroom = reader.fraction(false, denominator);
  GainMap map;
  map.by_iso = true;
  map.from_base = base_headroom <= alternate_headroom;
  constexpr std::array kFields{&GainMap::minimum, &GainMap::maximum, &GainMap::gamma, &GainMap::base_offset,
                               &GainMap::alternate_offset};
  const std::size_t channels = (flags & kEachChannel) != 0 ? 3 : 1;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    for (const auto field : kFields) {
      std::array<double, 3>& values = map.*field;
      values[channel] = channel < channels ? reader.fraction(field != &GainMap::gamma, denominator) : values[0];
    }
  }
  check(map, path);
  return map;
}

// Images.

// Marker codes, after a byte of 0xFF. (T.81, table B.1.)
constexpr unsigned kStartOfImage = 0xD8, kEndOfImage = 0xD9, kStartOfScan = 0xDA, kTemporary = 0x01;
constexpr unsigned kApplication1 = 0xE1, kApplication2 = 0xE2;

bool is_restart(unsigned code) { return code >= 0xD0 && code <= 0xD7; }

// Returns whether a code starts a frame: not Huffman tables (C4), an extension (C8) or arithmetic conditioning (CC).
bool is_frame(unsigned code) { return code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC; }
bool is_progressive(unsigned code) { return code == 0xC2 || code == 0xC6 || code == 0xCA || code == 0xCE; }

/// Reads a file's bytes in order, through a buffer.
class Bytes {
 public:
  Bytes(platform::ByteFile& file, std::uint64_t position) : file_(&file), begin_(position) {}

  [[nodiscard]] std::uint64_t position() const noexcept { return begin_ + used_; }
  [[nodiscard]] bool at_end() { return used_ == count_ && !fill(); }

  /// Returns the next byte. Throws the errors of `ByteFile::read` at the file's end.
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

/// Returns the primaries of an ICC profile that has a colour for each: tags rXYZ, gXYZ and bXYZ, adapted to D50, which
/// together make that white. (ICC.1:2010, 7.2 to 7.3, 9.2.)
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

/// sRGB's primaries as in its profiles, adapted to D50 by Bradford's transform. (IEC 61966-2-1; ICC's sRGB profile.)
constexpr Chromaticities kAdaptedSrgb{{0.6484, 0.3309}, {0.3212, 0.5978}, {0.1559, 0.0660}, {0.3457, 0.3585}};

void read_profile(JpegSegments& image, std::span<const std::uint8_t> segment) {
  // The name is followed by the part's number and the count. Profiles of several parts are tables, not primaries.
  const std::optional<Chromaticities> found =
      segment.size() > 2 && segment[1] == 1 ? primaries_of_profile(segment.subspan(2)) : std::nullopt;
  image.has_other_profile = !found;
  if (found && !nearly_same(*found, kAdaptedSrgb)) image.primaries = found;
}

/// Returns the bytes after a segment's name, which ends with a zero; nothing if the name is another.
std::optional<std::span<const std::uint8_t>> named(std::span<const std::uint8_t> segment, std::string_view name) {
  if (segment.size() < name.size() ||
      !std::equal(name.begin(), name.end(), segment.begin(),
                  [](char a, std::uint8_t b) { return static_cast<unsigned char>(a) == b; })) {
    return std::nullopt;
  }
  return segment.subspan(name.size());
}

void read_application(JpegSegments& image, unsigned code, const std::vector<std::uint8_t>& segment,
                      const std::filesystem::path& path) {
  if (code == kApplication1) {
    const auto packet = named(segment, "http://ns.adobe.com/xap/1.0/\0"sv);
    if (!packet || (image.gain_map && image.gain_map->by_iso)) return;
    const std::string text(packet->begin(), packet->end());
    if (const std::optional<GainMap> map = gain_map_from_xmp(text, path)) image.gain_map = map;
  } else if (const auto profile = named(segment, "ICC_PROFILE\0"sv)) {
    read_profile(image, *profile);
  } else if (const auto numbers = named(segment, "urn:iso:std:iso:ts:21496:-1\0"sv)) {
    if (const std::optional<GainMap> map = gain_map_from_iso(*numbers, path)) image.gain_map = map;
  }
}

void read_frame(JpegSegments& image, unsigned code, const std::vector<std::uint8_t>& segment, const Bytes& bytes) {
  if (segment.size() < 6) bytes.damaged("a frame's header is too short");
  image.bits = segment[0];
  image.height = segment[1] << 8U | segment[2];
  image.width = segment[3] << 8U | segment[4];
  image.components = segment[5];
  image.buffered = is_progressive(code);
}

/// Skips the coded samples of a scan up to the next marker, and returns its code.
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

/// Reads the image that begins at offset `begin` to its end.
JpegSegments read_image(platform::ByteFile& file, std::uint64_t begin) {
  JpegSegments image;
  image.begin = begin;
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
    if (is_frame(code)) read_frame(image, code, segment, bytes);
    if (code == kApplication1 || code == kApplication2) read_application(image, code, segment, bytes.path());
    if (code == kStartOfScan) {
      ++scans;
      components_in_scan = segment.empty() ? 0 : segment[0];
      code = marker_behind_scan(bytes);
    } else {
      code = next_marker(bytes);
    }
  }
  image.end = bytes.position();
  image.buffered = image.buffered || scans > 1 || components_in_scan < image.components;
  if (scans == 0 || image.width == 0 || image.height == 0) bytes.damaged("it has no image");
  if (image.bits != 8 || (image.components != 1 && image.components != 3)) {
    throw platform::file_error(ErrorCode::unsupported_file, bytes.path(),
                               "is a JPEG of " + std::to_string(image.components) + " components of " +
                                   std::to_string(image.bits) + " bits; 1 or 3 of 8 bits are read");
  }
  return image;
}

}  // namespace

std::vector<JpegSegments> jpeg_images(platform::ByteFile& file) {
  std::vector<JpegSegments> images{read_image(file, 0)};
  // Cameras pad between images, and keep previews, depths and films after them.
  constexpr std::size_t kMaxImages = 16;
  Bytes bytes(file, images[0].end);
  for (unsigned seen = 0;
       images.size() < kMaxImages && (images.size() == 1 || !images.back().gain_map) && !bytes.at_end();) {
    seen = (seen << 8U | bytes.next()) & 0xFFFFFFU;
    if (seen != 0xFFD8FF) continue;
    images.push_back(read_image(file, bytes.position() - 3));
    bytes = Bytes(file, images.back().end);
    seen = 0;
  }
  return images;
}

}  // namespace welkin::files
