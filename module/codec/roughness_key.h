// Whether a file's chain of levels is one of plain mips.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace welkin::codec {

/// Whether a key of a file's metadata speaks of roughness ("welkin.roughness"): then the smaller levels are blurred for
/// reflections, and none of them stands for the picture.
[[nodiscard]] inline bool speaks_of_roughness(std::string key) {
  std::transform(key.begin(), key.end(), key.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return key.find("roughness") != std::string::npos;
}

}  // namespace welkin::codec
