// Light inside the frame: the call returns when it is done.
#pragma once

#include <tbb/task_arena.h>

#include <vector>

#include "baker.h"

namespace engine_loop {

class SynchronousBaker final : public Baker {
 public:
  /// `arena` is the engine's: a call has all the threads that a frame has.
  explicit SynchronousBaker(tbb::task_arena& arena) : arena_(arena) {}

  void collect() override {}
  void ask(Posting posting) override;
  void finish() override {}

 private:
  tbb::task_arena& arena_;
  // Freed after the last frame: not the light's fault, and milliseconds for large pixels.
  std::vector<Posting> kept_;
};

}  // namespace engine_loop
