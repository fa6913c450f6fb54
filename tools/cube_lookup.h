// Looks a direction up in a cubemap as a graphics card does: bilinear, seamless across edges, linear between mips.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "welkin/cubemap_chain.h"
#include "welkin/image_view.h"

namespace welkin::tool {

class CubeLookup {
 public:
  /// Levels of packed rgb_f32, largest first, at least one; they are not copied.
  explicit CubeLookup(std::vector<CubemapView> levels) : levels_(std::move(levels)) {}
  explicit CubeLookup(const CubemapChain& chain) : CubeLookup(chain.views()) {}

  [[nodiscard]] int levels() const noexcept { return static_cast<int>(levels_.size()); }
  [[nodiscard]] int size(int level) const noexcept { return levels_[static_cast<std::size_t>(level)].size; }

  /// `direction` need not be of unit length, but must not be 0; a level beyond the last one is the last one.
  [[nodiscard]] glm::dvec3 at(const glm::dvec3& direction, int level) const;

  /// The same between two levels, `level` being a fraction.
  [[nodiscard]] glm::dvec3 at(const glm::dvec3& direction, double level) const;

 private:
  std::vector<CubemapView> levels_;
};

}  // namespace welkin::tool
