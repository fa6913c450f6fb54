#include "sky/sky_colour.h"

#include <algorithm>
#include <cstddef>

namespace welkin::sky {
namespace {

std::vector<glm::dvec3> channel_weights(const Atmosphere& atmosphere, SkyColour colour) {
  if (colour == SkyColour::linear_srgb) return srgb_weights(atmosphere.wavelengths_nm);
  return {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
}

}  // namespace

ColourFold::ColourFold(const Atmosphere& atmosphere, SkyColour colour) : weights_(channel_weights(atmosphere, colour)) {
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] *= i < atmosphere.solar_irradiance.size() ? atmosphere.solar_irradiance[i] : 0.0;
    sunlight_ += weights_[i];
  }
  for (int c = 0; c < 3; ++c) sunlight_[c] = std::max(sunlight_[c], 0.0);
}

glm::dvec3 ColourFold::share(std::span<const double> values) const noexcept {
  glm::dvec3 sum{};
  for (std::size_t i = 0; i < values.size() && i < weights_.size(); ++i) sum += weights_[i] * values[i];
  for (int c = 0; c < 3; ++c) sum[c] = sunlight_[c] > 0.0 ? std::max(sum[c] / sunlight_[c], 0.0) : 0.0;
  return sum;
}

}  // namespace welkin::sky
