#include "codec/hdr_texels.h"

#include <cmath>
#include <cstddef>

namespace welkin::codec {

HdrTexels::HdrTexels(const glm::dvec3& divisor, const std::optional<glm::dmat3>& matrix) : matrix_(matrix) {
  constexpr int kBias = 128 + 8;
  for (int component = 0; component < 3; ++component) {
    auto& scales = scales_[static_cast<std::size_t>(component)];
    for (int exponent = 1; exponent < 256; ++exponent) {
      scales[static_cast<std::size_t>(exponent)] = std::ldexp(1.0, exponent - kBias) / divisor[component];
    }
  }
}

void HdrTexels::convert(const std::uint8_t* planes, int length, bool reversed, float* rgb) const noexcept {
  const std::uint8_t* red = planes;
  const std::uint8_t* green = red + length;
  const std::uint8_t* blue = green + length;
  const std::uint8_t* exponents = blue + length;
  const std::ptrdiff_t step = reversed ? -3 : 3;
  float* texel = reversed ? rgb + std::ptrdiff_t{3} * (length - 1) : rgb;
  for (int i = 0; i < length; ++i, texel += step) {
    const std::size_t exponent = exponents[i];
    glm::dvec3 value(red[i] * scales_[0][exponent], green[i] * scales_[1][exponent], blue[i] * scales_[2][exponent]);
    if (matrix_) {
      value = *matrix_ * value;
    }
    texel[0] = static_cast<float>(value.r);
    texel[1] = static_cast<float>(value.g);
    texel[2] = static_cast<float>(value.b);
  }
}

}  // namespace welkin::codec
