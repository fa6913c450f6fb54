// The whole bridge from an engine's thread pool to a welkin::Worker: two functions.
#pragma once

#include <welkin/core.h>
#include <welkin/worker.h>

#include "thread_pool.h"

namespace own_executor {

class PoolExecutor final : public welkin::Executor {
 public:
  /// The pool must live for as long as the worker, so it is made before it.
  explicit PoolExecutor(ThreadPool& pool) : pool_(pool) {}

  [[nodiscard]] int concurrency() const noexcept override { return static_cast<int>(pool_.size()); }

  void enqueue(void (*run)(void* job), void* job) override {
    pool_.push([run, job] {
      // Welkin spreads the tiles of a job over the TBB arena of the thread that it is called on. An arena of one thread
      // keeps a job on this thread of the pool, so that oneTBB adds none of its own. Without it, call run(job) as it
      // is.
      welkin::run_with_threads(1, [run, job] { run(job); });
    });
  }

 private:
  ThreadPool& pool_;
};

}  // namespace own_executor
