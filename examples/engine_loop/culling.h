// Part of the simulated frame work: which of the scene's objects the camera sees.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

namespace engine_loop {

/// Six planes, normals inwards: a point p is inside where dot(normal, p) + w >= 0.
using Frustum = std::array<glm::vec4, 6>;

/// A camera at the scene's centre, turned about the vertical by an angle in radians.
[[nodiscard]] Frustum frustum_towards(float angle);

class Scene {
 public:
  explicit Scene(std::size_t objects);

  [[nodiscard]] std::size_t objects() const noexcept { return spheres_.size(); }

  /// Notes for the objects [begin, end) whether they are in sight. Other ranges may be culled at the same time.
  void cull(const Frustum& frustum, std::size_t begin, std::size_t end) noexcept;

 private:
  std::vector<glm::vec4> spheres_;  ///< bounding spheres: centre and radius, metres
  std::vector<std::uint8_t> visible_;
};

}  // namespace engine_loop
