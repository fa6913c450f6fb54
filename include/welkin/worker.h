// Light off the main thread: requests are posted to a worker, results come back when they are ready.
//
//   welkin::Worker worker;                                     // threads of its own, below the engine's in priority
//   auto job = worker.post(welkin::Project{std::move(image)}, {.key = "probe 7"});
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

// ---- Jobs: a posted job's result, and a handle on what becomes of it
//
//   if (auto light = job.try_take()) use(light->radiance);     // once a frame: never waits, and gives the result once

namespace detail {

template <class Result>
class Awaited;

struct JobAccess;

}  // namespace detail

/// Why a job has no result.
struct JobError {
  std::optional<ErrorCode> code;  ///< none if the request threw something else than `Error`
  std::string message;            ///< what the exception says
};

/// What can be asked and told of a posted job, by any number of copies from any thread, also after its worker is gone.
/// A default-made handle belongs to no job: its id is 0, it is never ready, and what it is told does nothing.
class JobHandle {
 public:
  JobHandle() = default;

  /// Unique in the process, and rising in the order of posting, from 1 on.
  [[nodiscard]] std::uint64_t id() const noexcept { return record_ ? record_->id : 0; }

  /// Whether the job has ended, with a result or with an error. `get()` does not wait then.
  [[nodiscard]] bool ready() const noexcept { return record_ && record_->ready.load(std::memory_order_acquire); }

  /// The share of the work that is done, 0 to 1. It never falls, and is 1 once there is a result.
  [[nodiscard]] double progress() const noexcept {
    return record_ ? record_->computation->progress.load(std::memory_order_relaxed) : 0.0;
  }

  /// Why the job failed; nothing while it runs and if it went well. It takes some microseconds for a job that failed.
  [[nodiscard]] std::optional<JobError> error() const;

  /// Cancels the job, which ends with an `Error` (cancelled). A waiting job ends at once. A running one stops before
  /// its next tile, and is ready when nothing reads the pixels any more. Cancelling a continuation cancels the job that
  /// it follows. Returns true if this call did it, false if the job was done or cancelled before.
  bool cancel() const;

  /// The job's priority; `normal` for no job.
  [[nodiscard]] TaskPriority priority() const;

  /// Changes the job's priority. A waiting job goes to the end of those of its new priority; if that is the old one, it
  /// stays where it is. A running job goes on as it is.
  void set_priority(TaskPriority priority) const;

 protected:
  friend struct detail::JobAccess;

  /// Of a job that was made.
  explicit JobHandle(std::shared_ptr<detail::JobRecord> record) : record_(std::move(record)) {}

  std::shared_ptr<detail::JobRecord> record_;  ///< shared with the worker; null: no job
};

/// A handle that also has the result. The result can be taken once, in one of five ways: `try_take()`, `get()`, `then`,
/// `on_drain`, `co_await`. (`future_of` makes a `std::future` of a job.) A job is moved, not copied;
/// the work of one that is let go of runs to its end.
template <class Result>
class Job : public JobHandle {
 public:
  /// No job.
  Job() = default;
  /// Moves: the source is no job afterwards.
  Job(Job&&) noexcept = default;
  /// As above. The job that it was before runs to its end.
  Job& operator=(Job&&) noexcept = default;

  /// Whether this is a job whose result can still be taken; also of one that failed.
  [[nodiscard]] bool valid() const noexcept { return record_ != nullptr && !taken_; }

  /// The result, moved out, if the job has ended well and the result was not taken before; else nothing, and `error()`
  /// tells of a failure. Never waits. A job without a result says true, once.
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

  /// Waits and moves the result out, or throws the job's error. It looks for 0.15 ms before it sleeps. On a thread of
  /// the worker it runs a job that has not started instead of waiting for another thread. A request must not wait for
  /// itself, directly or through other jobs: that wait never ends. Throws `Error` (invalid_argument) if the result was
  /// taken before, and if there is no job.
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

  /// `follow_up(result)`, or `follow_up(result, control)`, runs on a thread of the worker once the result is there;
  /// what it returns is the new job's result. If this job fails, the new one fails with the same error, and `follow_up`
  /// is not called. Continuations keep the priority of the job that they follow, start before waiting jobs of that
  /// priority, and do not count against the worker's limits. Throws std::bad_alloc.
  template <class FollowUp>
  [[nodiscard]] auto then(FollowUp follow_up) &&;

  /// `callback(Job<Result>)` runs inside the worker's `drain()` once the job has ended. The job that it gets is ready:
  /// `get()` gives the result or throws the error, and does not wait. The callback is not called if the worker is
  /// destroyed first. Throws std::bad_alloc.
  template <class Callback>
  void on_drain(Callback callback) &&;

  /// `co_await std::move(job)` gives the result or throws the error. The coroutine goes on on a thread of the worker,
  /// or in `terminate()` when that ends the job; it stays where it is if the job is ready. Post in a statement of its
  /// own, not inside the `co_await` expression: GCC 12 destroys temporaries twice there (lambdas with captures, braced
  /// aggregates).
  [[nodiscard]] auto operator co_await() && { return detail::Awaited<Result>(take_over(), detail::Place::worker); }

  /// `co_await std::move(job).drained()`: the same, but the coroutine goes on inside `drain()`, or in the worker's
  /// destructor if that is not called any more.
  [[nodiscard]] auto drained() && { return detail::Awaited<Result>(take_over(), detail::Place::drain); }

 private:
  friend struct detail::JobAccess;
  friend class detail::Awaited<Result>;

  explicit Job(std::shared_ptr<detail::JobRecord> record) : JobHandle(std::move(record)) {}

  [[nodiscard]] detail::TypedJobRecord<Result>& typed() const noexcept {
    return static_cast<detail::TypedJobRecord<Result>&>(*record_);
  }

  /// Another one with the result, which this one has no more.
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

/// Makes and posts jobs.
struct JobAccess {
  /// A job for the request, not posted yet.
  template <class Request, class From>
  static Job<ResultOf<Request>> make(From&& request) {
    auto computation =
        make_shared_in_job_memory<RequestComputation<Request>>(std::in_place, std::forward<From>(request));
    auto record = make_shared_in_job_memory<TypedJobRecord<ResultOf<Request>>>();
    record->computation = std::move(computation);
    return Job<ResultOf<Request>>(std::move(record));
  }

  /// Posts a job. `follower`, one computation or none, hangs on it from the beginning.
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

/// The request of a continuation: the follow-up, called with the result of the job that it follows.
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

/// Goes on with a coroutine, whatever became of the job that it awaits.
class Resumption final : public Computation {
 public:
  Resumption(std::coroutine_handle<> coroutine, Place its_place) : Computation(its_place), coroutine_(coroutine) {}

  void run(const Control&) override { coroutine_.resume(); }
  void abandon() override { coroutine_.resume(); }

 private:
  std::coroutine_handle<> coroutine_;
};

/// What `on_drain` hangs on a job.
template <class Result, class Callback>
class DrainCallback final : public Computation {
 public:
  DrainCallback(Job<Result> job, Callback callback)
      : Computation(Place::drain), job_(std::move(job)), callback_(std::move(callback)) {}

  void run(const Control&) override { std::invoke(callback_, std::move(job_)); }

 private:
  Job<Result> job_;
  Callback callback_;
};

/// What `co_await` on a job waits with.
template <class Result>
class Awaited {
 public:
  Awaited(Job<Result> job, Place place) : job_(std::move(job)), place_(place) {}

  [[nodiscard]] bool await_ready() const noexcept { return place_ == Place::worker && job_.ready(); }

  /// False: the coroutine just goes on.
  bool await_suspend(std::coroutine_handle<> coroutine) {
    // The coroutine may go on, and this object be gone, before `attach` returns.
    const std::shared_ptr<JobRecord> record = job_.record_;
    return attach(record, make_shared_in_job_memory<Resumption>(coroutine, place_), nullptr);
  }

  Result await_resume() { return job_.get(); }

 private:
  Job<Result> job_;
  Place place_;
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

// ---- Workers

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

// ---- A std::future of a job, for code that waits for futures of several libraries. It needs exceptions.
//
//   std::future<welkin::Projection> light = welkin::future_of(worker.post(welkin::Project{std::move(image)}));

namespace detail {

/// Fulfils a promise, on the thread that settles the job.
template <class Result>
class PromiseKeeper final : public Computation {
 public:
  explicit PromiseKeeper(Job<Result> job) : Computation(Place::at_once), job_(std::move(job)) {}

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

/// A `std::future` of the job's result or error. The job is taken: nobody else can take its result, and a copy of its
/// handle, made before, still cancels it. The future must not be waited for inside a request of the same worker,
/// because it does not help as `Job::get()` does (docs/guides/worker.md). Throws `Error` (invalid_argument) if the
/// result was taken before, and std::bad_alloc.
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
