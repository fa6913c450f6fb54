#include "codec/png_samples.h"

#include <array>
#include <cstring>
#include <glm/vec3.hpp>

#include "image/formats.h"

namespace welkin::codec {

PngSamples::PngSamples(bool sixteen_bits, Transfer transfer, const std::optional<glm::dmat3>& matrix)
    : sixteen_bits_(sixteen_bits), table_(sixteen_bits ? 65536 : 256), matrix_(matrix) {
  const auto largest = static_cast<double>(table_.size() - 1);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double encoded = static_cast<double>(i) / largest;
    table_[i] = static_cast<float>(transfer == Transfer::srgb ? image::linear_from_srgb(encoded) : encoded);
  }
}

void PngSamples::convert(const std::uint8_t* coded, std::size_t count, float* rgb) const noexcept {
  for (std::size_t i = 0; i < count; ++i, rgb += 3) {
    if (sixteen_bits_) {
      std::array<std::uint16_t, 3> texel{};
      std::memcpy(texel.data(), coded + 8 * i, sizeof(texel));
      rgb[0] = table_[texel[0]];
      rgb[1] = table_[texel[1]];
      rgb[2] = table_[texel[2]];
    } else {
      rgb[0] = table_[coded[3 * i]];
      rgb[1] = table_[coded[3 * i + 1]];
      rgb[2] = table_[coded[3 * i + 2]];
    }
    if (matrix_) {
      const glm::dvec3 colour = *matrix_ * glm::dvec3(rgb[0], rgb[1], rgb[2]);
      rgb[0] = static_cast<float>(colour.r);
      rgb[1] = static_cast<float>(colour.g);
      rgb[2] = static_cast<float>(colour.b);
    }
  }
}

}  // namespace welkin::codec
