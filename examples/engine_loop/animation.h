// Part of the simulated frame work: a crowd of characters, each a skeleton that is posed again every frame.
#pragma once

#include <array>
#include <cstddef>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace engine_loop {

class Crowd {
 public:
  explicit Crowd(std::size_t characters);

  [[nodiscard]] std::size_t characters() const noexcept { return palettes_.size(); }

  /// Poses one character at a time in seconds: a few microseconds. Others may be posed at the same time.
  void pose(std::size_t character, float time_s) noexcept;

 private:
  static constexpr std::size_t kBones = 60;
  static constexpr std::size_t kKeys = 32;
  static constexpr float kKeysPerSecond = 10.0F;

  using Key = std::array<glm::quat, kBones>;      ///< every bone's rotation against its parent
  using Palette = std::array<glm::mat4, kBones>;  ///< every bone's place in the world, as a skinning shader wants it

  std::vector<Key> clip_;  ///< kKeys of them, played in a circle
  std::vector<Palette> palettes_;
};

}  // namespace engine_loop
