// From Welkin's axes to Babylon.js's left-handed ones and back: x changes its sign.
#include <algorithm>

#include "codec/face_placement.h"
#include "welkin/babylon_environment.h"
#include "welkin/engine_light.h"
#include "welkin/harmonic_transforms.h"

namespace welkin {
namespace {

/// On every face columns run along or against x, or else against or along z where x is what tells +X from -X: so
/// those two change places, and the columns of all six run the other way.
void mirror_face(const float* from, int size, float* to) {
  const std::ptrdiff_t row_floats = std::ptrdiff_t{3} * size;
  for (std::ptrdiff_t row = 0; row < size; ++row) {
    codec::copy_segment(from + row * row_floats, to + row * row_floats, size, true);
  }
}

int mirrored_side(int side) { return side < 2 ? 1 - side : side; }

}  // namespace

CubemapChain mirrored_x(const CubemapChain& chain) {
  if (chain.levels() == 0) return {};
  CubemapChain mirrored(chain.size(), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    for (int side = 0; side < 6; ++side) {
      mirror_face(chain.face(level, side), chain.level_size(level), mirrored.face(level, mirrored_side(side)));
    }
  }
  return mirrored;
}

CubemapImage mirrored_x(const CubemapImage& cubemap) {
  CubemapImage mirrored{cubemap.size, std::vector<float>(cubemap.pixels.size())};
  const std::size_t face_values = cubemap.pixels.size() / 6;
  for (int side = 0; side < 6 && cubemap.size > 0; ++side) {
    mirror_face(cubemap.pixels.data() + static_cast<std::size_t>(side) * face_values, cubemap.size,
                mirrored.pixels.data() + static_cast<std::size_t>(mirrored_side(side)) * face_values);
  }
  return mirrored;
}

BabylonEnvironment to_babylon(const CubemapChain& specular, const SphericalHarmonics& radiance,
                              const CubemapImage& irradiance_over_pi) {
  BabylonEnvironment environment;
  environment.specular = mirrored_x(specular);
  environment.polynomial = babylon_polynomial(transform(radiance, convention(Engine::babylon).from_welkin));
  environment.irradiance = mirrored_x(irradiance_over_pi);
  return environment;
}

}  // namespace welkin
