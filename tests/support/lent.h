// Threads that a test lends to a worker.
#pragma once

#include <tbb/task_arena.h>

#include <memory>
#include <utility>

#include "welkin/worker.h"

namespace welkin::test {

/// A TBB arena as an engine would lend it.
class ArenaExecutor final : public Executor {
 public:
  explicit ArenaExecutor(tbb::task_arena& arena) : arena_(arena) {}

  [[nodiscard]] int concurrency() const noexcept override { return arena_.max_concurrency(); }
  void enqueue(void (*run)(void* job), void* job) override {
    arena_.enqueue([run, job] { run(job); });
  }

 private:
  tbb::task_arena& arena_;
};

inline WorkerOptions lent(std::shared_ptr<Executor> executor) {
  WorkerOptions options;
  options.executor = std::move(executor);
  return options;
}

inline WorkerOptions lent(tbb::task_arena& arena) { return lent(std::make_shared<ArenaExecutor>(arena)); }

}  // namespace welkin::test
