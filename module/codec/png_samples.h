// From a PNG's samples to RGB floats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>
#include <vector>

#include "welkin/environment_file.h"

namespace welkin::codec {

/// A sample of n bits is sample / (2^n - 1), through sRGB's curve or not, rounded once to float: a table of 256 or
/// 65536, made here and the same everywhere.
class PngSamples {
 public:
  /// `sixteen_bits`: RGBA of 16 bits in the machine's byte order; else RGB of 8. `transfer` is srgb or linear. Texels
  /// are multiplied by `matrix` in double, if there is one.
  PngSamples(bool sixteen_bits, Transfer transfer, const std::optional<glm::dmat3>& matrix);

  /// `coded`: `count` texels, of 3 or 8 bytes, at any address.
  void convert(const std::uint8_t* coded, std::size_t count, float* rgb) const noexcept;

  [[nodiscard]] std::uint64_t memory_bytes() const noexcept { return table_.size() * sizeof(float); }

 private:
  bool sixteen_bits_;
  std::vector<float> table_;
  std::optional<glm::dmat3> matrix_;
};

}  // namespace welkin::codec
