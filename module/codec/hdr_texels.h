// From a Radiance picture's bytes to RGB floats.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace welkin::codec {

/// A component is mantissa * 2^(exponent - 136); with exponent 0, all three are 0. Radiance's own programs add
/// a half to the mantissa, to undo the mean of what truncation took away; every other reader and the writers that
/// round do not, and nor does this: a float holds each such value exactly.
class HdrTexels {
 public:
  /// Components are divided by `divisor` (what that leaves is rounded to double, then to float), then multiplied by
  /// `matrix` in double, if there is one.
  HdrTexels(const glm::dvec3& divisor, const std::optional<glm::dmat3>& matrix);

  /// `planes`: four of `length` bytes, mantissas and exponents. Texels go to `rgb` from the last to the first if
  /// `reversed`.
  void convert(const std::uint8_t* planes, int length, bool reversed, float* rgb) const noexcept;

 private:
  std::array<std::array<double, 256>, 3> scales_{};  // of each component by exponent
  std::optional<glm::dmat3> matrix_;
};

}  // namespace welkin::codec
