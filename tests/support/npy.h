// NumPy's array files, as far as the shared pictures need them.
#pragma once

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temporary_directory.h"

namespace welkin::test {

/// The values of a version 1 .npy file of little-endian floats in C order; its shape is the caller's to know.
inline std::vector<float> read_npy(const std::filesystem::path& path) {
  const std::vector<char> bytes = read_bytes(path);
  constexpr std::size_t kPrefix = 10;  // magic, version, header length
  if (bytes.size() < kPrefix || std::string(bytes.data() + 1, 5) != "NUMPY" || bytes[6] != 1) {
    throw std::runtime_error("not a version 1 .npy file");
  }
  const std::size_t header = static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  const std::string description(bytes.data() + kPrefix, header);
  if (description.find("'<f4'") == std::string::npos || description.find("False") == std::string::npos) {
    throw std::runtime_error("not little-endian floats in C order: " + description);
  }
  std::vector<float> values((bytes.size() - kPrefix - header) / sizeof(float));
  std::memcpy(values.data(), bytes.data() + kPrefix + header, values.size() * sizeof(float));
  return values;
}

}  // namespace welkin::test
