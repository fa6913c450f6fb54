#include "worker_setup.h"

#include <welkin/core.h>

#include <memory>
#include <stdexcept>
#include <utility>

namespace engine_loop {
namespace {

/// A TBB arena, lent to the worker.
class ArenaExecutor final : public welkin::Executor {
 public:
  explicit ArenaExecutor(tbb::task_arena& arena) : arena_(arena) {}

  [[nodiscard]] int concurrency() const noexcept override { return arena_.max_concurrency(); }
  void enqueue(void (*run)(void* job), void* job) override {
    arena_.enqueue([run, job] { run(job); });
  }

 private:
  tbb::task_arena& arena_;
};

WorkerSetup own_threads(welkin::ThreadPriority priority, int threads) {
  WorkerSetup setup;
  setup.options.threads = threads;
  setup.options.thread_priority = priority;
  return setup;
}

WorkerSetup lent_by(tbb::task_arena& arena) {
  WorkerSetup setup;
  setup.options.executor = std::make_shared<ArenaExecutor>(arena);
  return setup;
}

WorkerSetup arena_of_low_priority(int threads) {
  const int slots = threads > 0 ? threads : welkin::available_threads();
  // No slot is reserved for a thread of the engine's: none ever goes in there.
  auto arena = std::make_shared<tbb::task_arena>(slots, 0, tbb::task_arena::priority::low);
  WorkerSetup setup = lent_by(*arena);
  setup.lent = std::move(arena);
  return setup;
}

}  // namespace

std::vector<std::string> setup_names() { return {"own-idle", "own-below", "own-normal", "lent", "lent-engine"}; }

WorkerSetup worker_setup(const std::string& name, int threads, tbb::task_arena& engine) {
  if (name == "own-idle") return own_threads(welkin::ThreadPriority::idle, threads);
  if (name == "own-below") return own_threads(welkin::ThreadPriority::below_normal, threads);
  if (name == "own-normal") return own_threads(welkin::ThreadPriority::normal, threads);
  if (name == "lent") return arena_of_low_priority(threads);
  if (name == "lent-engine") return lent_by(engine);
  throw std::invalid_argument(name + ": no such set-up");
}

}  // namespace engine_loop
