// What a job is made of: what its caller holds, and the computation behind it. Users need job.h and worker.h.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <future>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "welkin/control.h"
#include "welkin/error.h"
#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// Which waiting job a worker starts next: the higher one, and of equals the older one.
enum class Priority { low, normal, high };

namespace detail {

class WELKIN_HIDDEN Scheduler;
class Computation;
class JobRecord;
// Lists whose nodes are made when a job is posted and then only change hands, so that what happens when it starts, is
// given up or is done allocates nothing.
using ComputationList = std::list<std::shared_ptr<Computation>>;
using JobList = std::list<std::shared_ptr<JobRecord>>;
using ComputationIndex = std::multimap<std::size_t, std::shared_ptr<Computation>>;

/// Runs in `drain()` when a job is done.
struct Delivery {
  std::function<void()> run;
  bool even_at_the_end = false;  ///< also when the worker goes before it was drained: a coroutine must not be lost
};
using DeliveryList = std::list<Delivery>;

/// One posted job, as its worker keeps it.
class JobRecord {
 public:
  JobRecord() = default;
  virtual ~JobRecord() = default;
  JobRecord(const JobRecord&) = delete;
  JobRecord& operator=(const JobRecord&) = delete;

  /// Puts an error into the future.
  virtual void fail(std::exception_ptr error) = 0;

  // Constant once the job is posted.
  std::uint64_t id = 0;
  std::string key;
  std::shared_ptr<Scheduler> scheduler;
  std::shared_ptr<Computation> computation;

  std::atomic<bool> ready{false};  ///< the future has its result or error

  // Guarded by the scheduler's mutex.
  Priority priority = Priority::normal;
  bool counted = false;                ///< against the worker's limit of jobs
  bool settled = false;                ///< the outcome is decided: too late to give it up
  std::optional<ErrorCode> withdrawn;  ///< given up, and why
  JobList::iterator place;             ///< among its computation's jobs
  bool done = false;                   ///< what was attached has been passed on: what comes later goes on at once
  ComputationList continuation;        ///< to start when this job is done: none or one
  DeliveryList delivery;               ///< to drain when this job is done: none or one
};

template <class Result>
class TypedJobRecord final : public JobRecord {
 public:
  std::promise<Result> promise;

  void fail(std::exception_ptr error) override { promise.set_exception(std::move(error)); }
};

/// One piece of work: what is done once, for one job or for several equal ones.
class Computation {
 public:
  Computation() = default;
  virtual ~Computation() = default;
  Computation(const Computation&) = delete;
  Computation& operator=(const Computation&) = delete;

  /// Does the work and keeps the result. Throws what the work throws.
  virtual void run(const Control& control) = 0;
  /// Hands the result to a job: a copy, or, if this is the last one, the result itself.
  virtual void deliver(JobRecord& job, bool last) = 0;
  /// Whether this kind can serve several jobs at all.
  [[nodiscard]] virtual bool shareable() const noexcept { return false; }
  /// Whether a run that has started can serve one more: not if it may have read what has changed since.
  [[nodiscard]] virtual bool joinable_while_running() const noexcept { return true; }
  /// The same number for equal requests.
  [[nodiscard]] virtual std::size_t hash() const { return 0; }
  /// Whether `other` would give the same result, so that one run can serve both.
  [[nodiscard]] virtual bool equals(const Computation& /*other*/) const { return false; }
  /// Gives back the request's and the result's memory.
  virtual void release() noexcept = 0;
  /// Takes the place of `run` when the worker ends first; what waits for a result has got an error already.
  virtual void abandon() {}

  void report(double done) noexcept {
    double before = progress.load(std::memory_order_relaxed);
    while (done > before && !progress.compare_exchange_weak(before, std::min(done, 1.0), std::memory_order_relaxed)) {
    }
  }

  std::stop_source stop;
  std::atomic<double> progress{0.0};  ///< 0 to 1, never falling

  // Guarded by the scheduler's mutex.
  Priority priority = Priority::normal;  ///< the highest of its jobs'
  JobList jobs;                          ///< who waits for the result
  std::shared_ptr<JobRecord> parent;     ///< the job whose end starts this one, until then
  std::uint64_t bytes = 0;               ///< that count against the worker's limit
  long thread = 0;                       ///< the system's number of the thread that runs this
  ComputationList* list = nullptr;       ///< which list this is in (of those that wait, of those that run, or its
  ComputationList::iterator place;       ///< parent's continuation), and where in there
  bool indexed = false;                  ///< in the scheduler's index of what can be shared, and
  ComputationIndex::iterator entry;      ///< where in there
};

/// What a request gives: the result of calling it with a `Control`.
template <class Request>
using ResultOf = std::invoke_result_t<Request&, const Control&>;

/// Whether several equal requests may share one run. Functions, and lambdas that turn into them, do have an ==, but
/// the same function twice is meant to run twice.
template <class Request>
inline constexpr bool kShareable = std::is_class_v<Request>&& std::equality_comparable<Request>&&
                                       std::is_invocable_v<const Request&, const Control&> &&
                                   !requires(const Request& request) {
  +request;
}
&&(std::is_void_v<ResultOf<Request>> || std::copyable<ResultOf<Request>>);

template <class Request>
class RequestComputation final : public Computation {
 public:
  using Result = ResultOf<Request>;
  static_assert(std::is_void_v<Result> || std::is_object_v<Result>, "a request returns a value or nothing");

  template <class From>
  RequestComputation(std::in_place_t, From&& request) : request_(std::in_place, std::forward<From>(request)) {}

  void run(const Control& control) override {
    if constexpr (std::is_void_v<Result>) {
      std::invoke(*request_, control);
    } else {
      result_.emplace(std::invoke(*request_, control));
    }
  }

  void deliver(JobRecord& job, bool last) override {
    auto& promise = dynamic_cast<TypedJobRecord<Result>&>(job).promise;
    if constexpr (std::is_void_v<Result>) {
      promise.set_value();
    } else if constexpr (kShareable<Request>) {
      if (last) {
        promise.set_value(std::move(*result_));
      } else {
        Result copy(*result_);  // out here, so that what it throws does not pass through the promise
        promise.set_value(std::move(copy));
      }
    } else {
      promise.set_value(std::move(*result_));
    }
  }

  [[nodiscard]] bool shareable() const noexcept override { return kShareable<Request>; }

  [[nodiscard]] bool joinable_while_running() const noexcept override {
    return !requires { Request::kReadsFiles; };
  }

  [[nodiscard]] std::size_t hash() const override {
    const std::size_t kind = typeid(Request).hash_code();
    if constexpr (requires { std::as_const(*request_).hash(); }) {
      return kind ^ std::as_const(*request_).hash();
    } else {
      return kind;
    }
  }

  [[nodiscard]] bool equals(const Computation& other) const override {
    if constexpr (kShareable<Request>) {
      const auto* same_kind = dynamic_cast<const RequestComputation*>(&other);
      return same_kind != nullptr && std::as_const(*request_) == std::as_const(*same_kind->request_);
    } else {
      return false;
    }
  }

  void release() noexcept override {
    request_.reset();
    result_.reset();
  }

 private:
  using Stored = std::conditional_t<std::is_void_v<Result>, std::monostate, Result>;
  // What may be compared from other threads while it runs must not change by running.
  using Kept = std::conditional_t<kShareable<Request>, const Request, Request>;
  std::optional<Kept> request_;
  std::optional<Stored> result_;
};

/// `child` runs in the worker once `parent` is done, whatever its outcome; `job` (may be null) is the child's. False if
/// that cannot be any more, because the worker has ended; the job has got an error then.
bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
            const std::shared_ptr<JobRecord>& job);

/// `delivery` (one entry) runs in a `drain()` after `parent` is done. False if that cannot be any more.
bool attach(const std::shared_ptr<JobRecord>& parent, DeliveryList delivery);

/// Before a wait for the job. On one of the worker's own threads: if the job still waits, runs it here and now, as a
/// thread that waits for a job that waits for a thread would do neither. On others: looks for a moment.
void help(const std::shared_ptr<JobRecord>& job);

}  // namespace detail
}  // namespace welkin
