// The threads of an engine, lent to a worker.
#pragma once

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// An engine's thread pool, job system or TBB arena, behind two functions that the engine writes. A worker that has one
/// (`WorkerOptions::executor`) makes no threads. `examples/own_executor` is such a class over a plain thread pool.
///
/// A worker hands over at most `concurrency()` tasks at a time. Each runs one job; a further one is handed over when it
/// ends. Parallel work inside a job is TBB's, and spreads over the arena of the thread that calls `run`. An engine that
/// does not want oneTBB's pool beside its own threads calls `run` inside `welkin::run_with_threads(1, ...)`.
///
/// A worker uses its executor until `terminate()` or the worker's destructor returns. What was handed over may be
/// called later; it does nothing then.
class Executor {
 public:
  Executor() = default;
  virtual ~Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// How many jobs may run at the same time, from 1 on. The number must not change.
  [[nodiscard]] virtual int concurrency() const noexcept = 0;

  /// Has `run(job)` called once and soon, on a thread of the engine's choice. It comes from any thread, several at
  /// once, from inside `Worker::post` too, and should return at once. `run` throws nothing. A task that is never called
  /// is lost memory, and its job waits until the worker ends. What `enqueue` itself throws becomes the error of the
  /// jobs that nobody else would start; `run` must not be called then.
  virtual void enqueue(void (*run)(void* job), void* job) = 0;
};

}  // namespace welkin
