#include "platform/text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <system_error>

#include "platform/file.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {

namespace {

std::string degrees(double radians) { return significant(std::abs(radians) * 180.0 / std::numbers::pi, 4); }

}  // namespace

std::string significant(double value, int digits) {
  return platform::number_text(value + 0.0, std::chars_format::general, digits);  // + 0.0: no "-0"
}

std::string rough(double value) {
  return value < 999.5 ? significant(value, 3) : platform::number_text(value, std::chars_format::fixed, 0);
}

std::string significant(const glm::dvec3& rgb, int digits) {
  return significant(rgb.x, digits) + "  " + significant(rgb.y, digits) + "  " + significant(rgb.z, digits);
}

std::string all_digits(double value) { return platform::number_text(value + 0.0); }

std::string grouped(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, 1, ',');
  return text;
}

std::string counted(std::uint64_t count, std::string_view noun) {
  return grouped(count) + ' ' + std::string(noun) + (count == 1 ? "" : "s");
}

std::string counted(std::initializer_list<Count> counts) {
  std::vector<std::string> texts;
  for (const Count& count : counts) {
    if (count.number > 0) texts.push_back(counted(count.number, count.noun));
  }
  return joined(texts);
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size()) {
    text.replace(at, what.size(), with);
  }
  return text;
}

std::string duration(double milliseconds) {
  if (milliseconds < 999.5) return rough(milliseconds) + " ms";
  return rough(milliseconds / 1000.0) + " s";
}

std::string long_duration(double seconds) {
  constexpr long kMinute = 60;
  constexpr long kHour = 60 * kMinute;
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < kMinute) return std::to_string(whole) + " s";
  if (whole < kHour) return std::to_string(whole / kMinute) + " min " + std::to_string(whole % kMinute) + " s";
  return std::to_string(whole / kHour) + " h " + std::to_string(whole % kHour / kMinute) + " min";
}

std::string pad_left(std::string_view text, std::size_t width) {
  return std::string(width - std::min(width, text.size()), ' ') + std::string(text);
}

std::string pad_right(std::string_view text, std::size_t width) {
  return std::string(text) + std::string(width - std::min(width, text.size()), ' ');
}

NumberColumn::NumberColumn(double largest_magnitude) {
  constexpr int kDigits = 6;
  if (largest_magnitude == 0.0) return;
  scientific_ = !(largest_magnitude >= 1e-3 && largest_magnitude < 1e8);
  const int digits_before_point = scientific_ ? 1 : static_cast<int>(std::floor(std::log10(largest_magnitude))) + 1;
  decimals_ = std::max(0, kDigits - digits_before_point);
}

std::string NumberColumn::cell(double value, std::size_t width) const {
  const auto format = scientific_ ? std::chars_format::scientific : std::chars_format::fixed;
  const std::string text = platform::number_text(value, format, decimals_);
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  // A negative number that rounds to 0 would print as "-0.0000", which suggests a sign.
  const std::string unsigned_zero = is_zero && text.front() == '-' ? text.substr(1) : text;
  return ' ' + pad_left(unsigned_zero, width - 1);
}

std::string NumberColumn::cells(const glm::dvec3& rgb, std::size_t width) const {
  return cell(rgb.x, width) + cell(rgb.y, width) + cell(rgb.z, width);
}

double largest_magnitude(const glm::dvec3& rgb) {
  return std::max({std::abs(rgb.x), std::abs(rgb.y), std::abs(rgb.z)});
}

std::string direction_text(const glm::dvec3& unit, bool z_is_up) {
  const double elevation = std::asin(std::clamp(z_is_up ? unit.z : unit.y, -1.0, 1.0));
  const double azimuth = z_is_up ? std::atan2(unit.y, unit.x) : std::atan2(unit.x, unit.z);
  const std::string sign = azimuth < 0.0 ? "-" : "+";
  return '(' + significant(unit.x, 4) + ", " + significant(unit.y, 4) + ", " + significant(unit.z, 4) +
         "): " + degrees(elevation) + " degrees " + (elevation < 0.0 ? "down" : "up") + ", " + degrees(azimuth) +
         " degrees from " + (z_is_up ? "+x towards " + sign + "y" : "+z towards " + sign + "x");
}

const char* face_name(int face) noexcept {
  constexpr std::array<const char*, 6> kNames = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
  return kNames.at(static_cast<std::size_t>(face));
}

std::string printable(const std::string& text) { return platform::without_controls(text); }

std::string printable_lines(const std::string& text) {
  std::string lines;
  for (std::size_t start = 0;;) {
    const std::size_t end = text.find('\n', start);
    lines += printable(text.substr(start, end - start));
    if (end == std::string::npos) return lines;
    lines += '\n';
    start = end + 1;
  }
}

std::string portable_path(const std::string& path) {
  const std::filesystem::path whole = platform::path_of(path);
  if (!whole.is_absolute()) return path;
  const std::filesystem::path last = whole.has_filename() ? whole.filename() : whole.parent_path().filename();
  return platform::utf8(last);
}

bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  std::error_code unknown;
  const auto real = [&](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, unknown), unknown);
  };
  return std::filesystem::equivalent(one, other, unknown) || (real(one) == real(other) && !real(one).empty());
}

void require_kept(const std::filesystem::path& read, const std::filesystem::path& written, const std::string& writer,
                  const std::string& remedy) {
  if (!is_same_file(read, written)) return;
  throw Error(ErrorCode::file_access, platform::utf8(read) + ": is read, and " + writer + " would write over it as " +
                                          platform::utf8(written.filename()) + "; " + remedy);
}

bool begins_with(const std::filesystem::path& file, std::string_view sign) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return false;  // opening a pipe would wait
  std::ifstream stream(file, std::ios::binary);
  std::array<char, 256> first{};
  stream.read(first.data(), first.size());
  return std::string_view(first.data(), static_cast<std::size_t>(stream.gcount())).find(sign) != std::string_view::npos;
}

void require_own(const std::filesystem::path& file, std::string_view sign, const std::string& writer,
                 const std::string& remedy) {
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown) || begins_with(file, sign)) return;
  throw Error(ErrorCode::file_access, platform::utf8(file) + ": is there and was not written by 'welkin " + writer +
                                          "', which would write over it; " + remedy);
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  write_bytes(path, std::as_bytes(std::span(text)));
}

void write_bytes(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  platform::WholeFile file(path);
  file.write(bytes.data(), bytes.size());
  file.finish();
  file.commit();
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = std::size_t{1} << 20U;
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30U;

std::string system_reason() { return errno != 0 ? std::generic_category().message(errno) : "unknown reason"; }

}  // namespace

void for_each_line(const fs::path& file, const std::function<void(std::size_t number, const std::string& line)>& use) {
  std::size_t number = 1;
  const auto fail = [&](ErrorCode code, const std::string& what) {
    throw Error(code, platform::utf8(file) + ": " + what);
  };
  const auto fail_here = [&](ErrorCode code, const std::string& what) {
    fail(code, "line " + std::to_string(number) + ": " + what);
  };
  std::error_code unknown;
  const fs::file_status status = fs::status(file, unknown);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_fifo(status)) {
    fail(ErrorCode::file_access, "is neither a regular file nor a pipe; pass one of those");
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(ErrorCode::file_access, "cannot be read (" + system_reason() + "); check its permissions");
  std::uintmax_t bytes = 0;
  std::string line(kLongestLine + 1, '\0');
  while (stream.getline(line.data(), static_cast<std::streamsize>(line.size()))) {
    const auto read = static_cast<std::size_t>(stream.gcount());
    bytes += read;
    if (bytes > kMaxBytes) fail_here(ErrorCode::limit_exceeded, "the file is larger than a gigabyte; split it");
    use(number++, line.substr(0, stream.eof() ? read : read - 1));
  }
  if (stream.bad())
    fail_here(ErrorCode::file_access, "cannot be read (" + system_reason() + "); check its permissions");
  if (!stream.eof()) fail_here(ErrorCode::limit_exceeded, "is longer than a megabyte; is this the right file?");
}

}  // namespace welkin::tool
