#include "frame_work.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "clock.h"

namespace engine_loop {
namespace {

constexpr std::size_t kObjectsPerCharacter = 200;
constexpr std::size_t kObjectsPerTask = 4096;
constexpr float kCameraTurn_per_s = 0.5F;  // radians

/// The shortest of some frames, in milliseconds: the time of undisturbed work.
double undisturbed(FrameWork& work) {
  constexpr int kFrames = 40;
  double best = std::numeric_limits<double>::infinity();
  for (int frame = 0; frame < kFrames; ++frame) {
    const Clock::time_point start = Clock::now();
    work.run(0.016F * static_cast<float>(frame));
    best = std::min(best, milliseconds(Clock::now() - start));
  }
  return best;
}

}  // namespace

FrameWork::FrameWork(tbb::task_arena& arena, std::size_t characters)
    : arena_(&arena), crowd_(characters), scene_(kObjectsPerCharacter * characters) {}

FrameWork FrameWork::that_takes(double milliseconds, tbb::task_arena& arena) {
  FrameWork work(arena, 100);
  // The first guess is from cold caches and a cold pool; the second and third are near.
  for (int guess = 0; guess < 3; ++guess) {
    const double scale = milliseconds / undisturbed(work);
    work = FrameWork(arena, std::max<std::size_t>(
                                1, static_cast<std::size_t>(scale * static_cast<double>(work.characters()) + 0.5)));
  }
  return work;
}

void FrameWork::run(float time_s) {
  const Frustum frustum = frustum_towards(kCameraTurn_per_s * time_s);
  arena_->execute([&] {
    tbb::parallel_for(std::size_t{0}, crowd_.characters(),
                      [&](std::size_t character) { crowd_.pose(character, time_s); });
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scene_.objects(), kObjectsPerTask),
                      [&](const auto& range) { scene_.cull(frustum, range.begin(), range.end()); });
  });
}

}  // namespace engine_loop
