#include "tools/turn_chain.h"

#include <algorithm>
#include <cstddef>

#include "welkin/resampling.h"

namespace welkin::tool {

glm::dmat3 faces_of(Engine engine) {
  TurnOptions options;
  options.to = engine;
  return turn_of_picture(options, false, true);
}

CubemapChain turned(const CubemapChain& chain, const glm::dmat3& symmetry, const Control& control) {
  if (chain.levels() == 0) return {};
  const Control quiet{control.stop, {}};
  CubemapChain result(chain.size(), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    const CubemapImage image = to_cubemap(chain.view(level), chain.level_size(level), symmetry, quiet);
    const auto values = static_cast<std::ptrdiff_t>(image.pixels.size() / 6);
    for (int face = 0; face < 6; ++face) {
      std::copy_n(image.pixels.begin() + face * values, values, result.face(level, face));
    }
  }
  return result;
}

CubemapImage turned(const CubemapImage& cubemap, const glm::dmat3& symmetry, const Control& control) {
  if (cubemap.size == 0) return {};
  return to_cubemap(cubemap.view(), cubemap.size, symmetry, Control{control.stop, {}});
}

}  // namespace welkin::tool
