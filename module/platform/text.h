// Text, whatever C and C++ locales and code pages the host has set: numbers, and the names of files.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <version>

namespace welkin::platform {

#ifdef __cpp_lib_to_chars

using std::from_chars;

/// Returns the shortest text that identifies the double.
[[nodiscard]] inline std::string number_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Formats a number as printf's %.*g (general), %.*f (fixed) or %.*e (scientific) in the C locale.
[[nodiscard]] inline std::string number_text(double value, std::chars_format format, int precision) {
  std::array<char, 512> text{};  // DBL_MAX in fixed point takes 309 digits
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, format, precision).ptr};
}

#else  // libc++ 14 has it for integers only; where that is used (WebAssembly) the locale is always C's

[[nodiscard]] inline std::string number_text(double value, std::chars_format format, int precision) {
  const char* const pattern = format == std::chars_format::fixed        ? "%.*f"
                              : format == std::chars_format::scientific ? "%.*e"
                                                                        : "%.*g";
  std::array<char, 512> text{};
  std::sprintf(text.data(), pattern, precision, value);  // snprintf would link long doubles: 3 KB to download
  return text.data();
}

[[nodiscard]] inline std::string number_text(double value) {
  constexpr int kMaxDigits = 17;
  std::string text;
  for (int digits = 1; digits <= kMaxDigits; ++digits) {
    text = number_text(value, std::chars_format::general, digits);
    if (std::strtod(text.c_str(), nullptr) == value) break;
  }
  return text;
}

using std::from_chars;

/// Returns the length of the decimal number that the characters begin with, as `std::from_chars` reads it; 0 if none.
[[nodiscard]] inline std::size_t decimal_length(const char* first, const char* last) {
  const auto digits = [last](const char*& at) {
    const char* const begin = at;
    while (at != last && *at >= '0' && *at <= '9') ++at;
    return at != begin;
  };
  const char* at = first;
  if (at != last && *at == '-') ++at;
  bool number = digits(at);
  if (at != last && *at == '.') {
    const char* behind = at + 1;
    number = digits(behind) || number;
    if (number) at = behind;
  }
  if (!number) return 0;
  if (at != last && (*at == 'e' || *at == 'E')) {
    const char* behind = at + 1;
    if (behind != last && (*behind == '-' || *behind == '+')) ++behind;
    if (digits(behind)) at = behind;
  }
  return static_cast<std::size_t>(at - first);
}

/// Parses as std::from_chars does, but rejects infinities and NaN.
[[nodiscard]] inline std::from_chars_result from_chars(const char* first, const char* last, double& value) {
  const std::string text(first, decimal_length(first, last));
  if (text.empty()) return {first, std::errc::invalid_argument};
  const double read = std::strtod(text.c_str(), nullptr);
  if (read > std::numeric_limits<double>::max() || read < std::numeric_limits<double>::lowest()) {
    return {first + text.size(), std::errc::result_out_of_range};
  }
  value = read;
  return {first + text.size(), std::errc()};
}

#endif

/// Returns an enumerator's name out of `names`, indexed by value up to `last`; `otherwise` for other values.
template <auto last, std::size_t count>
[[nodiscard]] constexpr const char* name_in(const std::array<const char*, count>& names, decltype(last) value,
                                            const char* otherwise) noexcept {
  static_assert(count == static_cast<std::size_t>(last) + 1, "each enumerator has a name");
  const auto index = static_cast<std::size_t>(value);
  return index < count ? names[index] : otherwise;
}

/// Returns a path as UTF-8. (On Windows `path::string` uses the host's code page, and fails for a character that it
/// lacks.) On other systems the path's bytes are returned unchanged.
[[nodiscard]] inline std::string utf8(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

/// Returns a path as UTF-8 with '/' between its parts on every system: for plans, links and names that others read.
[[nodiscard]] inline std::string generic_utf8(const std::filesystem::path& path) {
  const std::u8string text = path.generic_u8string();
  return {text.begin(), text.end()};
}

/// Returns the path that UTF-8 names. Throws `Error` (invalid_argument) if the bytes are invalid and the system's paths
/// consist of characters, as on Windows.
[[nodiscard]] std::filesystem::path path_of(std::string_view utf8);

/// Throws `Error` (invalid_argument), "WHAT is VALUE; it must be from LOW to HIGH", for a number out of range or NaN.
/// Otherwise it allocates nothing.
void require_between(std::string_view what, double value, double low, double high);

}  // namespace welkin::platform
