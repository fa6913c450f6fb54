// Numbers as text: the same digits whatever C's and C++'s locales the host has set.
#pragma once

#include <array>
#include <charconv>
#include <string>

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

}  // namespace welkin::platform
