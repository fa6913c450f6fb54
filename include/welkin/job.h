// A job that was posted to a worker: its result, and a handle on what becomes of it.
//
//   if (auto light = job.try_take()) use(light->radiance);     // once a frame: never waits, and gives the result once
#pragma once

#include <coroutine>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "welkin/core.h"
#include "welkin/detail/computation.h"

namespace WELKIN_EXPORT welkin {

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
/// `on_drain`, `co_await`. (`future_of` of job_future.h makes a `std::future` of a job.) A job is moved, not copied;
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
  Resumption(std::coroutine_handle<> coroutine, Place its_place) : coroutine_(coroutine) {
    where = its_place;
    runs_after_errors = true;
  }

  void run(const Control&) override { coroutine_.resume(); }
  void abandon() override { coroutine_.resume(); }

 private:
  std::coroutine_handle<> coroutine_;
};

/// What `on_drain` hangs on a job.
template <class Result, class Callback>
class DrainCallback final : public Computation {
 public:
  DrainCallback(Job<Result> job, Callback callback) : job_(std::move(job)), callback_(std::move(callback)) {
    // Members of the base, which no initializer of this class can name.
    // NOLINTBEGIN(cppcoreguidelines-prefer-member-initializer)
    where = Place::drain;
    runs_after_errors = true;
    // NOLINTEND(cppcoreguidelines-prefer-member-initializer)
  }

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

}  // namespace welkin
