// A job that was posted to a worker: its result, and a handle on what becomes of it.
#pragma once

#include <chrono>
#include <coroutine>
#include <cstdint>
#include <future>
#include <memory>
#include <utility>

#include "welkin/detail/computation.h"
#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

namespace detail {

template <class Result>
class Awaited;

struct JobAccess;

}  // namespace detail

/// What can be asked and told of a posted job, by any number of copies from any thread, also after its worker is gone.
/// A default-made handle belongs to no job; it has id 0 and nothing else may be asked of it.
class JobHandle {
 public:
  JobHandle() = default;

  /// Unique in the process, rising in the order of posting; from 1 on.
  [[nodiscard]] std::uint64_t id() const noexcept { return record_ ? record_->id : 0; }

  /// Whether result or error are there: the future will not wait. (It turns true a moment after the future is set.)
  [[nodiscard]] bool ready() const noexcept { return record_->ready.load(std::memory_order_acquire); }

  /// The share of the work that is done, 0 to 1, never falling; 1 once there is a result.
  [[nodiscard]] double progress() const noexcept {
    return record_->computation->progress.load(std::memory_order_relaxed);
  }

  /// Gives the job up: its future gets an `Error` (cancelled). At once if it waits, or if others share its computation;
  /// else the computation stops before its next tile, and the future is ready when nothing reads the pixels any more.
  /// A continuation that is given up gives up the job that it follows. True if this call did it, false if the job was
  /// done, or given up before.
  bool cancel() const;

  [[nodiscard]] Priority priority() const;

  /// A waiting job goes to the end of those of its new priority; if that is the old one, it stays where it is. (A
  /// shared computation has the highest of its jobs'.) A running one goes on as it is.
  void set_priority(Priority priority) const;

 protected:
  friend struct detail::JobAccess;

  explicit JobHandle(std::shared_ptr<detail::JobRecord> record) : record_(std::move(record)) {}

  std::shared_ptr<detail::JobRecord> record_;
};

/// A handle that also has the result, which can be taken in one of five ways, once: `get()`, `future()`, `then`,
/// `on_drain`, `co_await`. Jobs are moved, not copied; one that is let go of runs to its end unheard. Taking a second
/// time, or from a default-made job, throws `Error` (invalid_argument).
template <class Result>
class Job : public JobHandle {
 public:
  Job() = default;

  /// Waits and moves the result out, or throws the job's error. It looks for 0.15 ms before it sleeps. On one of the
  /// worker's own threads it does not wait for a job to be started: it starts it itself.
  Result get() {
    check_untaken();
    detail::help(record_);
    return future_.get();
  }

  /// The future of the result, a plain one: `wait_for`, `get` and the rest. The job stays as a handle.
  [[nodiscard]] std::future<Result> future() {
    check_untaken();
    return std::move(future_);
  }

  /// `follow_up(result)`, or `follow_up(result, control)`, runs in the worker's arena once the result is there; what
  /// it returns is the new job's result. An error skips it and goes on to the new job. Continuations keep the priority
  /// of the job that they follow, start before waiting jobs of that priority, and do not count against the worker's
  /// limits. Throws std::bad_alloc.
  template <class FollowUp>
  [[nodiscard]] auto then(FollowUp follow_up) &&;

  /// `callback(std::future<Result>)` runs inside the worker's `drain()` once the job is done, with a future that is
  /// ready: `get()` gives the result or throws its error. Never called if the worker is destroyed first.
  /// Throws std::bad_alloc.
  template <class Callback>
  void on_drain(Callback callback) &&;

  /// `co_await std::move(job)` gives the result or throws the error. The coroutine goes on in the worker's arena, or in
  /// `terminate()` when that ends the job; where it is if the job is ready. Post in a statement of its own, not inside
  /// the `co_await` expression: GCC 12 destroys temporaries twice there (lambdas with captures, braced aggregates).
  [[nodiscard]] auto operator co_await() && {
    check_untaken();
    return detail::Awaited<Result>(std::move(*this), false);
  }

  /// `co_await std::move(job).drained()`: the same, but the coroutine goes on inside `drain()` (or, if that is not
  /// called any more, in the worker's destructor).
  [[nodiscard]] auto drained() && {
    check_untaken();
    return detail::Awaited<Result>(std::move(*this), true);
  }

 private:
  friend struct detail::JobAccess;
  friend class detail::Awaited<Result>;

  Job(std::shared_ptr<detail::JobRecord> record, std::future<Result> future)
      : JobHandle(std::move(record)), future_(std::move(future)) {}

  void check_untaken() const {
    if (!future_.valid()) throw Error(ErrorCode::invalid_argument, "the job's result was taken before, or it has none");
  }

  std::future<Result> future_;
};

namespace detail {

/// Makes jobs, for those who post.
struct JobAccess {
  /// A job for `computation`, not posted yet.
  template <class Request>
  static Job<ResultOf<Request>> make(const std::shared_ptr<RequestComputation<Request>>& computation) {
    using Result = ResultOf<Request>;
    auto record = std::make_shared<TypedJobRecord<Result>>();
    record->computation = computation;
    auto future = record->promise.get_future();
    return {std::move(record), std::move(future)};
  }

  static const std::shared_ptr<JobRecord>& record(const JobHandle& handle) { return handle.record_; }
};

/// The request of a continuation: the parent's result, then the follow-up.
template <class Result, class FollowUp>
struct Continuation {
  std::future<Result> parent;
  FollowUp follow_up;

  auto operator()(const Control& control) {
    if constexpr (std::is_void_v<Result>) {
      parent.get();
      if constexpr (std::is_invocable_v<FollowUp&, const Control&>) {
        return std::invoke(follow_up, control);
      } else {
        return std::invoke(follow_up);
      }
    } else if constexpr (std::is_invocable_v<FollowUp&, Result, const Control&>) {
      return std::invoke(follow_up, parent.get(), control);
    } else {
      return std::invoke(follow_up, parent.get());
    }
  }
};

/// Goes on with a coroutine.
class Resumption final : public Computation {
 public:
  explicit Resumption(std::coroutine_handle<> coroutine) : coroutine_(coroutine) {}

  void run(const Control&) override { coroutine_.resume(); }
  void abandon() override { coroutine_.resume(); }
  void deliver(JobRecord&, bool) override {}
  void release() noexcept override {}

 private:
  std::coroutine_handle<> coroutine_;
};

/// What `co_await` on a job waits with.
template <class Result>
class Awaited {
 public:
  Awaited(Job<Result> job, bool drained) : job_(std::move(job)), drained_(drained) {}

  [[nodiscard]] bool await_ready() const noexcept { return !drained_ && job_.ready(); }

  /// False: the coroutine just goes on.
  bool await_suspend(std::coroutine_handle<> coroutine) {
    // The coroutine may go on, and this object be gone, before `attach` returns.
    const std::shared_ptr<JobRecord> record = job_.record_;
    if (!drained_) return attach(record, std::make_shared<Resumption>(coroutine), nullptr);
    DeliveryList delivery;
    delivery.push_back({[coroutine] { coroutine.resume(); }, true});
    return attach(record, std::move(delivery));
  }

  Result await_resume() { return job_.future_.get(); }

 private:
  Job<Result> job_;
  bool drained_;
};

}  // namespace detail

template <class Result>
template <class FollowUp>
auto Job<Result>::then(FollowUp follow_up) && {
  check_untaken();
  using Request = detail::Continuation<Result, FollowUp>;
  auto computation = std::make_shared<detail::RequestComputation<Request>>(
      std::in_place, Request{std::move(future_), std::move(follow_up)});
  auto job = detail::JobAccess::make<Request>(computation);
  detail::attach(record_, computation, detail::JobAccess::record(job));
  return job;
}

template <class Result>
template <class Callback>
void Job<Result>::on_drain(Callback callback) && {
  check_untaken();
  // std::function wants what it holds to be copyable; a future is not.
  auto held = std::make_shared<std::pair<Callback, std::future<Result>>>(std::move(callback), std::move(future_));
  detail::DeliveryList delivery;
  delivery.push_back({[held] { std::invoke(held->first, std::move(held->second)); }, false});
  detail::attach(record_, std::move(delivery));
}

}  // namespace welkin
