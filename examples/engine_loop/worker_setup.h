// The ways to set a worker up that the loop can compare.
#pragma once

#include <tbb/task_arena.h>
#include <welkin/worker.h>

#include <memory>
#include <string>
#include <vector>

namespace engine_loop {

struct WorkerSetup {
  welkin::WorkerOptions options;
  std::shared_ptr<tbb::task_arena> lent;  ///< must outlive the worker; empty if the worker has threads of its own
};

/// own-idle, own-below, own-normal: threads of its own, of that priority.
/// lent: a TBB arena of low priority, in addition to the engine's own, served by the same pool.
/// lent-engine: the arena that frames are computed in, to show why not.
[[nodiscard]] std::vector<std::string> setup_names();

/// `threads` of the worker or of the lent arena; 0: as many as the process may use. `engine` is the frames' arena.
[[nodiscard]] WorkerSetup worker_setup(const std::string& name, int threads, tbb::task_arena& engine);

}  // namespace engine_loop
