#include "animation.h"

#include <cmath>

namespace engine_loop {
namespace {

constexpr float kBoneLength_m = 0.1F;
constexpr std::size_t kChainLength = 12;  // bones from the root to a finger's end

/// The quaternion between two near ones, without the arcs that a slerp takes.
glm::quat blend(const glm::quat& a, const glm::quat& b, float share) noexcept {
  return glm::normalize(a * (1.0F - share) + b * share);
}

/// Any smooth motion does: each bone swings about an axis of its own.
glm::quat swing(std::size_t key, std::size_t keys, std::size_t bone) {
  const float turn = 6.2831853F * static_cast<float>(key) / static_cast<float>(keys);
  const auto number = static_cast<float>(bone);
  const glm::vec3 axis = glm::normalize(glm::vec3(std::sin(number), std::cos(number), 0.5F));
  return glm::angleAxis(0.3F * std::sin(turn + 0.2F * number), axis);
}

}  // namespace

Crowd::Crowd(std::size_t characters) : clip_(kKeys), palettes_(characters) {
  for (std::size_t key = 0; key < kKeys; ++key) {
    for (std::size_t bone = 0; bone < kBones; ++bone) clip_[key][bone] = swing(key, kKeys, bone);
  }
}

void Crowd::pose(std::size_t character, float time_s) noexcept {
  // Nobody walks in step.
  const float position = kKeysPerSecond * time_s + 0.37F * static_cast<float>(character);
  const float floor = std::floor(position);
  const std::size_t from = static_cast<std::size_t>(floor) % kKeys;
  const Key& before = clip_[from];
  const Key& after = clip_[(from + 1) % kKeys];

  Palette& palette = palettes_[character];
  glm::mat4 root(1.0F);
  root[3] = glm::vec4(static_cast<float>(character % 32), 0.0F, static_cast<float>(character / 32), 1.0F);
  for (std::size_t bone = 0; bone < kBones; ++bone) {
    glm::mat4 local = glm::mat4_cast(blend(before[bone], after[bone], position - floor));
    local[3] = glm::vec4(0.0F, kBoneLength_m, 0.0F, 1.0F);
    palette[bone] = (bone % kChainLength == 0 ? root : palette[bone - 1]) * local;
  }
}

}  // namespace engine_loop
