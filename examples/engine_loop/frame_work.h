// The work that an engine has in every frame anyway: a crowd of characters, whose skeletons are posed in a TBB arena.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <utility>
#include <vector>

namespace engine_loop {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

class FrameWork {
 public:
  FrameWork(tbb::task_arena& arena, std::size_t characters) : arena_(&arena), clip_(kKeys), palettes_(characters) {
    for (std::size_t key = 0; key < kKeys; ++key) {
      for (std::size_t bone = 0; bone < kBones; ++bone) clip_[key][bone] = swing(key, bone);
    }
  }

  /// Work that takes about as long on this machine when nothing disturbs it.
  [[nodiscard]] static FrameWork that_takes(double wanted_ms, tbb::task_arena& arena) {
    FrameWork work(arena, 100);
    // The first guess is from cold caches and a cold pool; the second and third are near.
    for (int guess = 0; guess < 3; ++guess) {
      const double scale = wanted_ms / work.undisturbed_ms();
      const auto characters = static_cast<std::size_t>(scale * static_cast<double>(work.characters()) + 0.5);
      work = FrameWork(arena, std::max<std::size_t>(1, characters));
    }
    return work;
  }

  /// Does one frame's work, at a time in seconds.
  void run(float time_s) {
    arena_->execute([&] {
      tbb::parallel_for(std::size_t{0}, characters(), [&](std::size_t character) { pose(character, time_s); });
    });
  }

  [[nodiscard]] std::size_t characters() const noexcept { return palettes_.size(); }

 private:
  static constexpr std::size_t kBones = 60, kKeys = 32;
  using Key = std::array<glm::quat, kBones>;      ///< each bone's rotation relative to its parent
  using Palette = std::array<glm::mat4, kBones>;  ///< each bone in the world, as a skinning shader wants it

  /// Any smooth motion does: each bone swings about an axis of its own.
  static glm::quat swing(std::size_t key, std::size_t bone) {
    const float turn = 6.2831853F * static_cast<float>(key) / static_cast<float>(kKeys);
    const auto number = static_cast<float>(bone);
    const glm::vec3 axis = glm::normalize(glm::vec3(std::sin(number), std::cos(number), 0.5F));
    return glm::angleAxis(0.3F * std::sin(turn + 0.2F * number), axis);
  }

  void pose(std::size_t character, float time_s) noexcept {
    constexpr std::size_t kChainLength = 12;  // bones from the root to a finger's end
    const float position = 10.0F * time_s + 0.37F * static_cast<float>(character);  // ten keys per second, out of step
    const float floor = std::floor(position), share = position - floor;
    const Key& before = clip_[static_cast<std::size_t>(floor) % kKeys];
    const Key& after = clip_[(static_cast<std::size_t>(floor) + 1) % kKeys];
    Palette& palette = palettes_[character];
    glm::mat4 root(1.0F);
    root[3] = glm::vec4(static_cast<float>(character % 32), 0.0F, static_cast<float>(character / 32), 1.0F);
    for (std::size_t bone = 0; bone < kBones; ++bone) {
      // The rotation between two near ones, without the arcs that a slerp takes.
      glm::mat4 local = glm::mat4_cast(glm::normalize(before[bone] * (1.0F - share) + after[bone] * share));
      local[3] = glm::vec4(0.0F, 0.1F, 0.0F, 1.0F);
      palette[bone] = (bone % kChainLength == 0 ? root : palette[bone - 1]) * local;
    }
  }

  /// The shortest of some frames.
  double undisturbed_ms() {
    double best = std::numeric_limits<double>::infinity();
    for (int frame = 0; frame < 40; ++frame) {
      const Clock::time_point start = Clock::now();
      run(0.016F * static_cast<float>(frame));
      best = std::min(best, milliseconds(Clock::now() - start));
    }
    return best;
  }

  tbb::task_arena* arena_;
  std::vector<Key> clip_;  ///< kKeys of them, played in a circle
  std::vector<Palette> palettes_;
};

}  // namespace engine_loop
