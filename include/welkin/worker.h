// Light off the main thread: requests are posted to a worker, results come back when they are ready.
//
//   welkin::Worker worker;                                     // threads of its own, below the engine's in priority
//   auto job = worker.post(welkin::ProjectCubemap{std::move(image)}, {.key = "probe 7"});
//   ...                                                        // later, once a frame
//   if (auto light = job.try_take()) use(light->radiance);     // never waits, and gives the result once
//
// or, with callbacks that run when the engine says so:
//
//   worker.post(welkin::ProjectFile{"sky.exr"}).on_drain([](welkin::Job<welkin::Projection> light) { ... });
//   worker.drain(std::chrono::microseconds(500));              // once a frame, at most half a millisecond
//
// docs/guides/worker.md says which thread runs what.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "welkin/core.h"
#include "welkin/job.h"
#include "welkin/requests.h"

namespace WELKIN_EXPORT welkin {

// ---- The threads of an engine, lent to a worker

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

// ---- The worker

/// A worker's threads and limits.
struct WorkerOptions {
  /// 0: one less than the process may use (`available_threads()`, which knows the container's CPU quota), so that one
  /// processor is the frame's own; at least 1. Else 1 to 1024. They run on the processors that the thread which makes
  /// the worker may run on.
  int threads = 0;

  /// The rank of the worker's threads among all threads of the machine. `idle` disturbs frames least, and delivers
  /// nothing while other programs keep all processors busy.
  ThreadPriority thread_priority = ThreadPriority::below;

  /// Of the threads, as debuggers and profilers show it; a number is put behind it. Linux keeps 15 characters.
  std::string name = "welkin";

  /// The engine's threads, lent to the worker. The worker then has no threads, priority and name of its own, and only
  /// the thread that a job is run on counts as the worker's, not those that join in its tiles. Do not lend the TBB
  /// arena in which frames are computed: a frame's thread that waits there would pick up a whole job. Null: own
  /// threads.
  std::shared_ptr<Executor> executor{};

  /// Limit on jobs in flight: posted, and not yet ready. A job that is posted at a limit ends with an `Error`
  /// (queue_full).
  std::size_t max_jobs = 4096;
  /// Limit on the bytes of their requests. (The memory itself comes back right after a job is ready.)
  std::uint64_t max_bytes = std::uint64_t{4} << 30U;
};

/// How a job is posted.
struct PostOptions {
  TaskPriority priority = TaskPriority::normal;  ///< among the jobs that wait

  /// Latest wins: a job with the same key that waits or runs is given up for this one, and ends with an `Error`
  /// (replaced). If it ran, it reads its pixels until it is ready. Jobs that take longer than the time between two
  /// posts of their key never end. Empty: no key. Copied by `post`.
  std::string_view key{};

  /// What the request counts against `WorkerOptions::max_bytes`; by default what its `bytes()` says, or 0.
  std::optional<std::uint64_t> bytes{};
};

/// What is in a worker's hands.
struct WorkerLoad {
  std::size_t waiting =
      0;  ///< computations that no thread has started, continuations of unfinished jobs not among them
  std::size_t running = 0;  ///< computations
  /// The time for which the oldest waiting computation has waited for a thread; 0 if none waits. It rises to seconds if
  /// the worker's threads get no processor, or long requests occupy them all.
  std::chrono::nanoseconds oldest_wait{0};
  std::size_t undrained = 0;  ///< callbacks that the next `drain()` would call
  std::size_t jobs = 0;       ///< in flight, as `max_jobs` counts them
  std::uint64_t bytes = 0;    ///< in flight, as `max_bytes` counts them
};

/// Runs requests on threads of its own, or on those of an engine's `Executor`.
///
/// A request is anything that can be called with a `const Control&`, from any thread, and returns a result or nothing:
/// those of requests.h, or a callable of the engine's own over any of Welkin's calls. Its parallel work should use TBB,
/// or nothing: it runs inside the worker's TBB arena, and all of Welkin's calls spread over that. (It should not open
/// arenas of its own: threads that oneTBB makes for them may rank as low as the worker's, for good.) It should look at
/// the control's stop token, and may report progress. Its results are the bits that a direct call gives.
///
/// If it has a member `bytes()`, that counts against the worker's memory limit.
///
/// The worker's threads stay in the process that made it. In a fork of that process its members and those of its jobs
/// that would need them throw `Error` (stopped) instead of waiting for ever; `cancel` returns false, and the destructor
/// leaves all as it is. A fork may make a worker of its own, unless its parent had one or a call of it computed when it
/// forked: then the constructor throws (docs/guides/worker.md).
///
/// All members may be called from any thread, from the worker's own too. Whatever goes wrong in a request, running out
/// of memory included, arrives through its job.
class Worker {
 public:
  /// Throws `Error` (invalid_argument) for options out of range, `Error` (stopped) in a fork that has locks which
  /// nobody opens, std::system_error if no thread can be made.
  explicit Worker(WorkerOptions options = {});

  /// `terminate()`; callbacks that were not drained are dropped.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Takes a request over and returns at once. As long as the worker is below its limits, `post` waits for no lock that
  /// a thread of the worker holds: what a post does to other jobs (a replaced job's error) has happened when it
  /// returns, or happens as soon as the thread that keeps the books goes on. At the limits the job ends with an `Error`
  /// (queue_full), one larger than `max_bytes` with `limit_exceeded`, one that comes after `terminate()` with
  /// `stopped`. Throws std::bad_alloc if there is no memory for the job itself, and what moving the request throws;
  /// nothing is posted then.
  template <class Request>
  auto post(Request&& request, const PostOptions& options = {}) -> JobOf<Request> {
    const std::uint64_t bytes = detail::bytes_of(request);
    auto job = detail::JobAccess::make<std::decay_t<Request>>(std::forward<Request>(request));
    submit(detail::JobAccess::record(job), options, bytes, {});
    return job;
  }

  /// Calls the callbacks of jobs that were done before the call, in the order in which they finished, on this thread:
  /// at least one if there is one, then until the budget is spent. The exception is a thread of the worker that holds
  /// its books and is kept off the processors: after 0.1 ms, or the budget if that is longer, the call gives up waiting
  /// for it. What a callback throws comes out here; the others wait for the next call. Returns how many were called.
  std::size_t drain(std::chrono::nanoseconds budget = std::chrono::nanoseconds::max());

  /// Gives up all jobs (they end with an `Error` (stopped)), waits until none runs, and ends the threads.
  /// Later posts are `stopped` too; callbacks can still be drained. On one of the worker's own threads (in a request, a
  /// continuation, a coroutine) it cannot wait: it returns, and the threads end when their work does. So the
  /// destructor.
  void terminate();

  /// Waits until nothing waits or runs; not for callbacks. Not on the worker's own threads: it returns at once.
  void wait_until_idle();

  /// Returns what the worker has in hand at this moment. Cost: proportional to the number of waiting computations.
  [[nodiscard]] WorkerLoad load() const;

  /// How many jobs it runs at once: its threads, or what its executor says.
  [[nodiscard]] int threads() const noexcept;

 private:
  friend struct detail::JobAccess;

  void submit(const std::shared_ptr<detail::JobRecord>& job, const PostOptions& options, std::uint64_t bytes,
              detail::ComputationList follower);

  std::shared_ptr<detail::Scheduler> scheduler_;
};

}  // namespace welkin
