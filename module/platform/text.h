// Text, whatever C's and C++'s locales and code pages the host has set: numbers, and the names of files.
#pragma once

#include <array>
#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>

namespace welkin::platform {

/// As few digits as tell it from every other double.
[[nodiscard]] inline std::string number_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// As printf's %.*g (general), %.*f (fixed) or %.*e (scientific) in C's own locale.
[[nodiscard]] inline std::string number_text(double value, std::chars_format format, int precision) {
  std::array<char, 512> text{};  // DBL_MAX in fixed point takes 309 digits
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, format, precision).ptr};
}

/// A path as UTF-8. (`path::string` has the host's code page on Windows, and fails where that has no such character.)
/// Elsewhere paths are bytes, and these are they.
[[nodiscard]] inline std::string utf8(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

/// The path that UTF-8 names. Throws `Error` (invalid_argument) where the system's paths are characters, as on Windows,
/// and these bytes are none.
[[nodiscard]] std::filesystem::path path_of(std::string_view utf8);

}  // namespace welkin::platform
