#include <cmath>
#include <string>
#include <system_error>
#include <utility>

#include "files/jpeg.h"
#include "math/elementary.h"
#include "platform/file.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

using namespace std::string_view_literals;

constexpr double kLogarithmOf2 = 0.69314718055994530942;

// Beyond this many stops no float is left; nobody means it.
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

// XMP, as much of it as gain maps use: a property is an attribute, name="1.5", or an element with one value or a list
// of them, <name>1.5</name> or <name><rdf:Seq><rdf:li>1.5</rdf:li>...</rdf:Seq></name>. (XMP specification, part 1, 7.)

bool is_space(char letter) { return letter == ' ' || letter == '\t' || letter == '\n' || letter == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// The prefix that a packet gives a namespace, xmlns:prefix="uri"; empty if it does not name it.
std::string prefix_of(std::string_view packet, std::string_view uri) {
  const std::size_t at = packet.find(uri);
  if (at == std::string_view::npos || at < 3) return {};
  const std::string_view before = trimmed(packet.substr(0, at - 1));  // without the quote
  if (before.empty() || before.back() != '=') return {};
  const std::string_view name = trimmed(before.substr(0, before.size() - 1));
  const std::size_t colon = name.rfind("xmlns:"sv);
  return colon == std::string_view::npos ? std::string() : std::string(name.substr(colon + 6));
}

/// The texts of a property: none, one, or those of its list.
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

  /// One value for all channels, or one for each; without any, `values` stays.
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

/// Big-endian numbers, one after the other. (ISO 21496-1:2025, annex C.2.)
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

  /// A fraction of two numbers of 4 bytes; `denominator` is 0 where each has its own.
  double fraction(bool is_signed, std::uint32_t denominator) {
    const std::uint32_t numerator = unsigned_number(4);
    const std::uint32_t below = denominator != 0 ? denominator : unsigned_number(4);
    if (below == 0) damaged(path_, "a fraction is divided by zero");
    // Two's complement, without leaving what the language defines.
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

}  // namespace

std::optional<GainMap> gain_map_from_xmp(std::string_view packet, const std::filesystem::path& path) {
  std::string prefix = prefix_of(packet, "http://ns.adobe.com/hdr-gain-map/1.0/"sv);
  if (prefix.empty()) return std::nullopt;
  const XmpReader reader(packet, std::move(prefix), path);
  if (!reader.has("GainMapMax")) return std::nullopt;  // the base picture's, which says the version alone
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

std::optional<GainMap> gain_map_from_iso(std::span<const std::uint8_t> bytes, const std::filesystem::path& path) {
  IsoReader reader(bytes, path);
  const std::uint32_t minimum_version = reader.unsigned_number(2);
  (void)reader.unsigned_number(2);  // the writer's
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

GainCurve::GainCurve(const GainMap& map) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    minimum_[channel] = map.minimum[channel] * kLogarithmOf2;
    range_[channel] = (map.maximum[channel] - map.minimum[channel]) * kLogarithmOf2;
    exponent_[channel] = 1.0 / map.gamma[channel];
  }
}

double GainCurve::factor(std::size_t channel, double sample) const noexcept {
  double share = sample / 255.0;
  if (exponent_[channel] != 1.0 && share > 0.0) {
    share = math::exponential(exponent_[channel] * math::logarithm(share));
  }
  return math::exponential(minimum_[channel] + range_[channel] * share);
}

}  // namespace welkin::files
