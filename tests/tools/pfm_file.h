// Writes small PFM files: the simplest format that the command reads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <vector>

namespace welkin::test {

/// `rgb`: width x height x 3 floats, row 0 on top (PFM keeps its rows bottom-up). Little-endian.
inline void write_pfm(const std::filesystem::path& path, int width, int height, const std::vector<float>& rgb) {
  std::ofstream file(path, std::ios::binary);
  file << "PF\n" << width << ' ' << height << "\n-1.0\n";
  const std::size_t row_values = static_cast<std::size_t>(width) * 3;
  for (int row = height - 1; row >= 0; --row) {
    const float* values = rgb.data() + static_cast<std::size_t>(row) * row_values;
    file.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(row_values * sizeof(float)));
  }
}

/// The same grey everywhere.
inline std::vector<float> grey_picture(int width, int height, float value) {
  return std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3, value);
}

}  // namespace welkin::test
