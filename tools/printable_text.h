// Text from a file, made fit for a terminal.
#pragma once

#include <algorithm>
#include <string>

namespace welkin::tool {

/// Every control character becomes '?': a file's channel names must not steer the reader's terminal.
[[nodiscard]] inline std::string printable(std::string text) {
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text;
}

}  // namespace welkin::tool
