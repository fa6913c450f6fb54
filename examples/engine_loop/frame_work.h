// What the engine does in every frame anyway: animation, then culling, each spread over its own TBB arena.
#pragma once

#include <tbb/task_arena.h>

#include <cstddef>
#include <memory>

#include "animation.h"
#include "culling.h"

namespace engine_loop {

class FrameWork {
 public:
  FrameWork(tbb::task_arena& arena, std::size_t characters);

  /// As much work as takes about that long on this machine when nothing disturbs it: the best of several tries counts.
  [[nodiscard]] static FrameWork that_takes(double milliseconds, tbb::task_arena& arena);

  /// One frame's work; returns when it is done.
  void run(float time_s);

  [[nodiscard]] std::size_t characters() const noexcept { return crowd_.characters(); }
  [[nodiscard]] std::size_t objects() const noexcept { return scene_.objects(); }

 private:
  tbb::task_arena* arena_;
  Crowd crowd_;
  Scene scene_;
};

}  // namespace engine_loop
