// PFM files, written by the tests.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace welkin::test {

/// Returns a PFM's bytes. `values`: width x height x (3 or 1), row 0 on top; `scale` as it is written, its sign stating
/// the byte order of the pixels that follow.
inline std::vector<char> pfm_bytes(int width, int height, bool grey, const std::string& scale,
                                   const std::vector<float>& values) {
  const std::string header = std::string(grey ? "Pf" : "PF") + "\n" + std::to_string(width) + " " +
                             std::to_string(height) + "\n" + scale + "\n";
  std::vector<char> bytes(header.begin(), header.end());
  const std::size_t row_values = static_cast<std::size_t>(width) * (grey ? 1 : 3);
  for (int row = height - 1; row >= 0; --row) {
    for (std::size_t i = 0; i < row_values; ++i) {
      char value[4];
      std::memcpy(value, &values[static_cast<std::size_t>(row) * row_values + i], 4);
      if (scale.front() != '-') {
        std::reverse(value, value + 4);
      }
      bytes.insert(bytes.end(), value, value + 4);
    }
  }
  return bytes;
}

}  // namespace welkin::test
