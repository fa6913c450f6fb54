// Baking off the main thread: requests are posted to a worker, and results are polled or delivered by callback.
//
//   welkin::Worker worker;                                     // own threads, at a lower priority than the engine's
//   auto job = worker.post(welkin::Project{std::move(image)});
//   ...                                                        // later, once per frame
//   if (auto light = job.try_take()) use(light->radiance);     // never waits; returns the result once
//
// or, with callbacks that run when the engine calls `drain`:
//
//   worker.post(welkin::ProjectFile{"sky.exr"}).on_drain([](welkin::Job<welkin::Projection> light) { ... });
//   worker.drain(std::chrono::microseconds(500));              // once per frame; begins no callback after 0.5 ms
//
// Members of `Worker` and `JobHandle` may be called from any thread at any time, including the worker's threads.
// docs/guides/worker.md states which thread runs what.
#pragma once

#include <chrono>
#include <coroutine>
#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "welkin/core.h"
#include "welkin/detail/computation.h"
#include "welkin/requests.h"

namespace WELKIN_EXPORT welkin {

// ---- Jobs: handles of posted requests, and their results

namespace detail {

template <class Result>
class Awaited;

struct JobAccess;

}  // namespace detail

/// The error of a failed job.
struct JobError {
  std::optional<ErrorCode> code;  ///< empty if the request threw something other than `Error`
  std::string message;            ///< message of the exception
};

/// Handle of a posted job. Copyable; stays valid after the worker is destroyed. A default-constructed handle refers to
/// no job: its id is 0, it is never ready, and its other members have no effect.
class JobHandle {
 public:
  JobHandle() = default;

  /// Returns the id of the job, from 1 on: unique in the process, and increasing in the order of posting.
  [[nodiscard]] std::uint64_t id() const noexcept { return record_ ? record_->id : 0; }

  /// Returns whether the job has completed, with a result or an error. `get()` then does not wait.
  [[nodiscard]] bool ready() const noexcept { return record_ && record_->ready.load(std::memory_order_acquire); }

  /// Returns the fraction of the work that is done, 0 to 1. It never decreases, and is 1 once there is a result.
  [[nodiscard]] double progress() const noexcept {
    return record_ ? record_->computation->progress.load(std::memory_order_relaxed) : 0.0;
  }

  /// Returns the error of a failed job, at every call; nothing while the job runs and if it succeeded. Takes
  /// microseconds for a failed job.
  [[nodiscard]] std::optional<JobError> error() const;

  /// Cancels the job; it completes with ErrorCode::cancelled. A waiting job completes at once. A running one stops
  /// before its next tile and completes when its pixels are no longer read. Cancelling a continuation also cancels the
  /// job before it. Returns true if this call cancelled the job, false if it had completed or been cancelled before.
  bool cancel() const;

  /// Returns the job's priority, or `normal` for no job.
  [[nodiscard]] TaskPriority priority() const;

  /// Changes the job's priority. A waiting job moves to the end of the queue of its new priority; with its current
  /// priority it keeps its position. A running job is not affected.
  void set_priority(TaskPriority priority) const;

 protected:
  friend struct detail::JobAccess;

  /// Creates the handle of a job.
  explicit JobHandle(std::shared_ptr<detail::JobRecord> record) : record_(std::move(record)) {}

  std::shared_ptr<detail::JobRecord> record_;  ///< shared with the worker; null for no job
};

/// A job with its result. The result can be taken once, by one of `try_take()`, `get()`, `then`, `on_drain` and
/// `co_await` (or `future_of`, which makes a `std::future`). Movable, not copyable. Destroying a job does not cancel
/// its work.
template <class Result>
class Job : public JobHandle {
 public:
  /// Creates no job.
  Job() = default;
  /// Moves a job; the source then refers to no job.
  Job(Job&&) noexcept = default;
  /// Moves a job. The job that this object referred to before still runs to completion.
  Job& operator=(Job&&) noexcept = default;

  /// Returns whether a result or an error can still be taken.
  [[nodiscard]] bool valid() const noexcept { return record_ != nullptr && !taken_; }

  /// Returns the result by moving it out, if the job has succeeded and the result was not taken before. Otherwise
  /// returns nothing; `error()` reports a failure. Never waits. For a job without a result type, returns true once.
  [[nodiscard]] auto try_take() {
    using Taken = std::conditional_t<std::is_void_v<Result>, bool, std::optional<detail::Stored<Result>>>;
    if (!valid() || !ready() || record_->failed()) return Taken();
    taken_ = true;
    if constexpr (std::is_void_v<Result>) {
      return true;
    } else {
      return std::exchange(typed().result, std::nullopt);
    }
  }

  /// Waits and returns the result by moving it out, or throws the job's error. Spins for up to 0.15 ms, then blocks. On
  /// a thread of the worker, it runs a job that has not started instead of waiting for another thread. A request that
  /// waits for itself, directly or through other jobs, deadlocks. Throws `Error` (invalid_argument) if the result was
  /// taken before or there is no job.
  Result get() {
    if (!valid()) detail::throw_taken();
    detail::wait(record_);
    taken_ = true;
    detail::throw_error_of(*record_);
    if constexpr (!std::is_void_v<Result>) {
      Result result(std::move(*typed().result));
      typed().result.reset();
      return result;
    }
  }

  /// Posts a continuation: `follow_up(result)` or `follow_up(result, control)` runs on a thread of the worker once the
  /// result is available, and its return value is the result of the new job. If this job fails, the new one fails with
  /// the same error and `follow_up` is not called. Continuations have the priority of the job before them, start before
  /// waiting jobs of that priority, and do not count against the worker's limits. Throws std::bad_alloc.
  template <class FollowUp>
  [[nodiscard]] auto then(FollowUp follow_up) &&;

  /// Registers a callback: `callback(Job<Result>)` runs inside the worker's `drain()` once the job has completed. The
  /// job passed to it is ready: its `try_take()` returns the result or nothing, and its `get()` returns the result or
  /// throws the error, without waiting. The callback is not called if the worker is destroyed first. Throws
  /// std::bad_alloc.
  template <class Callback>
  void on_drain(Callback callback) &&;

  /// Returns the result of `co_await std::move(job)`, or throws the error. The coroutine resumes on a thread of the
  /// worker, or inside `terminate()` if that ends the job; if the job is ready, it does not suspend. Post the job in a
  /// statement of its own: GCC 12 destroys temporaries of a `co_await` expression twice (lambdas with captures, braced
  /// aggregates).
  [[nodiscard]] auto operator co_await() && { return detail::Awaited<Result>(take_over(), detail::CallSite::worker); }

  /// Returns an awaitable like that of `co_await`, except that the coroutine resumes inside `drain()`, or in the
  /// worker's destructor if `drain()` is not called again.
  [[nodiscard]] auto drained() && { return detail::Awaited<Result>(take_over(), detail::CallSite::drain); }

 private:
  friend struct detail::JobAccess;
  friend class detail::Awaited<Result>;

  explicit Job(std::shared_ptr<detail::JobRecord> record) : JobHandle(std::move(record)) {}

  [[nodiscard]] detail::TypedJobRecord<Result>& typed() const noexcept {
    return static_cast<detail::TypedJobRecord<Result>&>(*record_);
  }

  /// Moves the right to take the result to another job object.
  [[nodiscard]] Job take_over() {
    if (!valid()) detail::throw_taken();
    taken_ = true;
    return Job(record_);
  }

  bool taken_ = false;
};

/// The type of the job that posting a request returns, such as `JobOf<BakeFile>`.
template <class Request>
using JobOf = Job<detail::ResultOf<std::decay_t<Request>>>;

namespace detail {

/// Creates and posts jobs.
struct JobAccess {
  /// Creates a job for the request without posting it.
  template <class Request, class From>
  static Job<ResultOf<Request>> make(From&& request) {
    auto computation =
        make_shared_in_job_memory<RequestComputation<Request>>(std::in_place, std::forward<From>(request));
    auto record = make_shared_in_job_memory<TypedJobRecord<ResultOf<Request>>>();
    record->computation = std::move(computation);
    return Job<ResultOf<Request>>(std::move(record));
  }

  /// Posts a job. `follower`, at most one computation, is attached from the beginning.
  template <class Worker, class Result, class Options>
  static void submit(Worker& worker, const Job<Result>& job, const Options& options, std::uint64_t bytes,
                     ComputationList follower) {
    worker.submit(job.record_, options, bytes, std::move(follower));
  }

  static const std::shared_ptr<JobRecord>& record(const JobHandle& handle) { return handle.record_; }

  template <class Result>
  static Job<Result> take_over(Job<Result>& job) {
    return job.take_over();
  }
};

/// Request of a continuation: calls the follow-up with the result of the job before it.
template <class Result, class FollowUp>
struct Continuation {
  Job<Result> parent;
  FollowUp follow_up;

  auto operator()(const Control& control) {
    if constexpr (std::is_void_v<Result>) {
      if constexpr (std::is_invocable_v<FollowUp&, const Control&>) {
        return std::invoke(follow_up, control);
      } else {
        return std::invoke(follow_up);
      }
    } else if constexpr (std::is_invocable_v<FollowUp&, Result, const Control&>) {
      return std::invoke(follow_up, *parent.try_take(), control);
    } else {
      return std::invoke(follow_up, *parent.try_take());
    }
  }
};

/// Resumes a coroutine after the job that it awaits, whether that succeeded or not.
class Resumption final : public Computation {
 public:
  Resumption(std::coroutine_handle<> coroutine, CallSite its_site) : Computation(its_site), coroutine_(coroutine) {}

  void run(const Control&) override { coroutine_.resume(); }
  void abandon() override { coroutine_.resume(); }

 private:
  std::coroutine_handle<> coroutine_;
};

/// Computation that `on_drain` attaches to a job.
template <class Result, class Callback>
class DrainCallback final : public Computation {
 public:
  DrainCallback(Job<Result> job, Callback callback)
      : Computation(CallSite::drain), job_(std::move(job)), callback_(std::move(callback)) {}

  void run(const Control&) override { std::invoke(callback_, std::move(job_)); }

 private:
  Job<Result> job_;
  Callback callback_;
};

/// Awaitable of `co_await` on a job.
template <class Result>
class Awaited {
 public:
  Awaited(Job<Result> job, CallSite site) : job_(std::move(job)), site_(site) {}

  [[nodiscard]] bool await_ready() const noexcept { return site_ == CallSite::worker && job_.ready(); }

  /// Returns false if the coroutine need not suspend.
  bool await_suspend(std::coroutine_handle<> coroutine) {
    // The coroutine may go on, and this object be gone, before `attach` returns.
    const std::shared_ptr<JobRecord> record = job_.record_;
    return attach(record, make_shared_in_job_memory<Resumption>(coroutine, site_), nullptr);
  }

  Result await_resume() { return job_.get(); }

 private:
  Job<Result> job_;
  CallSite site_;
};

}  // namespace detail

/// \cond Doxygen does not find the declarations of these two.
template <class Result>
template <class FollowUp>
auto Job<Result>::then(FollowUp follow_up) && {
  using Request = detail::Continuation<Result, FollowUp>;
  auto job = detail::JobAccess::make<Request>(Request{take_over(), std::move(follow_up)});
  const std::shared_ptr<detail::JobRecord>& record = detail::JobAccess::record(job);
  detail::attach(record_, record->computation, record);
  return job;
}

template <class Result>
template <class Callback>
void Job<Result>::on_drain(Callback callback) && {
  using Drained = detail::DrainCallback<Result, Callback>;
  detail::attach(record_, detail::make_shared_in_job_memory<Drained>(take_over(), std::move(callback)), nullptr);
}
/// \endcond

// ---- Threads of an engine, lent to a worker

/// Adapter to an engine's thread pool, job system or TBB arena: two functions that the engine implements. A worker with
/// an executor (`WorkerOptions::executor`) creates no threads. `examples/own_executor` implements one over a plain
/// thread pool.
///
/// A worker has at most `concurrency()` tasks enqueued at a time. Each task runs one job; when it ends, the next task
/// is enqueued. Work inside a job is parallel in the TBB arena of the thread that calls `run`. To keep oneTBB from
/// using threads of its own, call `run` inside `welkin::run_with_threads(1, ...)`.
///
/// A worker uses its executor until `terminate()` or the worker's destructor returns. Enqueued tasks may run later;
/// they have no effect then.
class Executor {
 public:
  Executor() = default;
  virtual ~Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// Returns the number of jobs that may run at the same time, at least 1. The number must not change.
  [[nodiscard]] virtual int concurrency() const noexcept = 0;

  /// Arranges for `run(job)` to be called once, soon, on a thread of the engine's choice. May be called concurrently
  /// from any thread, including from within `Worker::post`; must return quickly. `run` does not throw. A task that is
  /// never called leaks memory, and its job waits until the worker is destroyed. If `enqueue` throws, it must not call
  /// `run`; the exception becomes the error of the jobs that would otherwise never start.
  virtual void enqueue(void (*run)(void* job), void* job) = 0;
};

// ---- The worker

/// Threads and limits of a worker.
struct WorkerOptions {
  /// Number of threads, 1 to 1024. 0 uses one less than `available_threads()`, at least 1, which leaves one processor
  /// to the frame. Threads have the processor affinity of the thread that creates the worker.
  int threads = 0;

  /// Priority of the worker's threads on this machine. `idle` disturbs frames least, but makes no progress while other
  /// programs keep all processors busy.
  ThreadPriority thread_priority = ThreadPriority::below_normal;

  /// Name of the threads in debuggers and profilers, followed by a number. Linux keeps 15 characters.
  std::string name = "welkin";

  /// Threads of the engine for the worker to use; null for threads of its own. With an executor, `threads`,
  /// `thread_priority` and `name` are ignored, and only the thread that runs a job counts as the worker's, not those
  /// that help with its tiles. Do not lend the TBB arena in which frames are computed, because a frame's thread that
  /// waits there would start a whole job.
  std::shared_ptr<Executor> executor{};

  /// Limit on jobs in flight, that is posted and not ready. A job posted at the limit completes with
  /// ErrorCode::queue_full.
  std::size_t max_jobs = 4096;
  /// Limit on the bytes of requests in flight. Their memory is freed right after the job is ready.
  std::uint64_t max_bytes = std::uint64_t{4} << 30U;
};

/// Options of `Worker::post`.
struct PostOptions {
  TaskPriority priority = TaskPriority::normal;  ///< position among waiting jobs

  /// Replaces older jobs with the same key, whether they wait or run: those complete with ErrorCode::replaced. A
  /// running job that is replaced reads its pixels until it is ready. If every post replaces the job before it, no job
  /// ever yields a result. An empty key replaces nothing. The key is copied.
  std::string_view key{};

  /// Bytes to count against `WorkerOptions::max_bytes`. If empty: the request's `bytes()`, or 0 if it has none.
  std::optional<std::uint64_t> bytes{};
};

/// Load of a worker at one moment.
struct WorkerLoad {
  std::size_t waiting = 0;  ///< computations not started yet, without continuations of unfinished jobs
  std::size_t running = 0;  ///< computations that run
  /// Time for which the oldest waiting computation has waited for a thread; 0 if none waits. It reaches seconds if the
  /// worker's threads get no CPU time, or if long requests occupy all of them.
  std::chrono::nanoseconds oldest_wait{0};
  std::size_t undrained = 0;  ///< callbacks that the next `drain()` would call
  std::size_t jobs = 0;       ///< jobs in flight, as counted by `max_jobs`
  std::uint64_t bytes = 0;    ///< bytes in flight, as counted by `max_bytes`
};

/// Runs requests on threads of its own, or on those of an engine's `Executor`.
///
/// A request is any callable that takes a `const Control&` and returns a result or nothing: those of requests.h, or
/// your own over Welkin's calls. It runs inside the worker's TBB arena and may be called on any of its threads. It
/// should check the control's stop token and may report progress. It should not create arenas of its own, because
/// threads that oneTBB creates for them may keep the worker's low priority for good. If it has a member `bytes()`, that
/// counts against the worker's memory limit. Any exception that it throws, including std::bad_alloc, becomes the error
/// of its job.
///
/// After a fork, the worker's threads exist in the parent only. In the child, members that would need them throw
/// `Error` (stopped) instead of waiting forever; `cancel` returns false and the destructor does nothing. The child may
/// create its own worker, unless the parent had a worker or a running call when it forked: the constructor then throws
/// (docs/guides/worker.md).
class Worker {
 public:
  /// Creates a worker. Throws `Error`: invalid_argument for options out of range, stopped in a forked child whose
  /// inherited locks can never be released; and std::system_error if no thread can be created.
  explicit Worker(WorkerOptions options = {});

  /// Calls `terminate()` and drops callbacks that were not drained.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Posts a request and returns at once. Below the worker's limits, `post` never waits for a lock that a thread of the
  /// worker holds; effects on other jobs, such as the error of a replaced job, may become visible after it returns.
  ///
  /// The job completes with an `Error`: queue_full at the worker's limits, limit_exceeded for a request larger than
  /// `max_bytes`, stopped after `terminate()`. Throws std::bad_alloc if there is no memory for the job, and whatever
  /// moving the request throws; nothing is posted then.
  template <class Request>
  auto post(Request&& request, const PostOptions& options = {}) -> JobOf<Request> {
    const std::uint64_t bytes = detail::bytes_of(request);
    auto job = detail::JobAccess::make<std::decay_t<Request>>(std::forward<Request>(request));
    submit(detail::JobAccess::record(job), options, bytes, {});
    return job;
  }

  /// Calls the callbacks of jobs that completed before this call, in the order of completion, on this thread. Calls at
  /// least one if any is waiting, and begins no other after the budget is spent. Returns how many it called. An
  /// exception thrown by a callback leaves this function; the remaining callbacks run in the next call.
  ///
  /// Exception: if the system has suspended a thread of the worker that holds the scheduler's lock, `drain` returns
  /// after 0.1 ms, or after the budget if that is longer, and may call none.
  std::size_t drain(std::chrono::nanoseconds budget = std::chrono::nanoseconds::max());

  /// Cancels all jobs, which complete with ErrorCode::stopped, waits until none runs, and ends the threads. Later posts
  /// complete with ErrorCode::stopped; callbacks can still be drained. On a thread of the worker (in a request,
  /// continuation or coroutine) it does not wait; the threads then end when their work does. The destructor behaves the
  /// same way.
  void terminate();

  /// Waits until no job waits or runs; callbacks may remain. Returns at once on a thread of the worker.
  void wait_until_idle();

  /// Returns the current load. Cost: proportional to the number of waiting computations.
  [[nodiscard]] WorkerLoad load() const;

  /// Returns the number of jobs that run at once: the number of threads, or the executor's `concurrency()`.
  [[nodiscard]] int threads() const noexcept;

 private:
  friend struct detail::JobAccess;

  void submit(const std::shared_ptr<detail::JobRecord>& job, const PostOptions& options, std::uint64_t bytes,
              detail::ComputationList follower);

  std::shared_ptr<detail::Scheduler> scheduler_;
};

// ---- A std::future of a job, for code that waits for futures of several libraries
//
//   std::future<welkin::Projection> light = welkin::future_of(worker.post(welkin::Project{std::move(image)}));

namespace detail {

/// Fulfils a promise on the thread that completes the job.
template <class Result>
class PromiseKeeper final : public Computation {
 public:
  explicit PromiseKeeper(Job<Result> job) : Computation(CallSite::at_once), job_(std::move(job)) {}

  [[nodiscard]] std::future<Result> future() { return promise_.get_future(); }

  void run(const Control&) override {
    if (failure) {
      promise_.set_exception(failure);
    } else if constexpr (std::is_void_v<Result>) {
      promise_.set_value();
    } else {
      promise_.set_value(job_.get());
    }
  }

 private:
  Job<Result> job_;
  std::promise<Result> promise_{std::allocator_arg, JobAllocator<Result>()};
};

}  // namespace detail

/// Returns a `std::future` of the job's result or error. The future takes the result; copies of the job's handle can
/// still cancel it. Do not wait for the future inside a request of the same worker, because unlike `Job::get()` it does
/// not help with waiting jobs (docs/guides/worker.md). Throws `Error` (invalid_argument) if the result was taken
/// before, and std::bad_alloc.
template <class Result>
[[nodiscard]] std::future<Result> future_of(Job<Result> job) {
  const auto record = detail::JobAccess::record(job);
  const auto keeper =
      detail::make_shared_in_job_memory<detail::PromiseKeeper<Result>>(detail::JobAccess::take_over(job));
  std::future<Result> future = keeper->future();
  detail::attach(record, keeper, nullptr);
  return future;
}

}  // namespace welkin
