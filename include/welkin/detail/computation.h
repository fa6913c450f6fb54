// Implementation of jobs: the record that a job's handles share, and the computation behind it. Include worker.h
// instead.
//
// Nothing in this header throws or catches, so that a host may compile it without exceptions. An exception thrown by a
// request is caught in the library and kept in the job's record.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "welkin/core.h"

namespace WELKIN_EXPORT welkin {

/// Priority of waiting jobs: higher priorities start first, equal ones in the order of posting.
enum class TaskPriority { low, normal, high };

namespace detail {

class WELKIN_HIDDEN Scheduler;
class Computation;
class JobRecord;

/// Allocates memory for posts that threads of the worker free. It does not use the system's allocator: a low-priority
/// thread that is suspended while freeing a block may hold a lock that the posting thread's next allocation needs.
/// Freed blocks are kept in lock-free lists for later posts until a worker is destroyed; blocks above 4 KB go to the
/// system at once. Throws std::bad_alloc.
[[nodiscard]] void* allocate_job_memory(std::size_t bytes);
void free_job_memory(void* block, std::size_t bytes) noexcept;

template <class Type>
struct JobAllocator {
  using value_type = Type;

  JobAllocator() = default;
  template <class Other>
  JobAllocator(const JobAllocator<Other>&) noexcept {}  // NOLINT(google-explicit-constructor): allocators convert

  [[nodiscard]] Type* allocate(std::size_t count) {
    if constexpr (kAligned) return std::allocator<Type>().allocate(count);
    return static_cast<Type*>(allocate_job_memory(count * sizeof(Type)));
  }
  void deallocate(Type* block, std::size_t count) noexcept {
    if constexpr (kAligned) return std::allocator<Type>().deallocate(block, count);
    free_job_memory(block, count * sizeof(Type));
  }

  template <class Other>
  bool operator==(const JobAllocator<Other>&) const noexcept {
    return true;
  }

 private:
  static constexpr bool kAligned = alignof(Type) > __STDCPP_DEFAULT_NEW_ALIGNMENT__;
};

template <class Type, class... Arguments>
[[nodiscard]] std::shared_ptr<Type> make_shared_in_job_memory(Arguments&&... arguments) {
  return std::allocate_shared<Type>(JobAllocator<Type>(), std::forward<Arguments>(arguments)...);
}

/// A list whose nodes are allocated when a job is posted and then only moved, so that cancelling or completing a job
/// allocates nothing.
using ComputationList = std::list<std::shared_ptr<Computation>, JobAllocator<std::shared_ptr<Computation>>>;
using JobKey = std::basic_string<char, std::char_traits<char>, JobAllocator<char>>;

/// A byte whose address identifies a type. It is not constant, because linkers may merge equal constants. Two shared
/// libraries may each have one for the same type, which then counts as two types.
template <class Type>
inline char type_tag = 0;

/// A stored result.
template <class Result>
using Stored = std::conditional_t<std::is_void_v<Result>, std::monostate, Result>;

/// State of one posted job, shared by its handles and its worker.
class JobRecord {
 public:
  explicit JobRecord(const void* its_result_type) noexcept : result_type(its_result_type) {}
  JobRecord(const JobRecord&) = delete;
  JobRecord& operator=(const JobRecord&) = delete;

  // Constant once the job is posted.
  const void* result_type;  ///< address of its `type_tag`
  std::uint64_t id = 0;
  JobKey key;
  std::shared_ptr<Scheduler> scheduler;
  std::shared_ptr<Computation> computation;  ///< the computation of the result

  // Written before `ready` is set, and read after it.
  std::exception_ptr error;            ///< why the computation has no result
  std::optional<ErrorCode> withdrawn;  ///< why the job was withdrawn; until ready, guarded by the scheduler's mutex
  std::atomic<bool> ready{false};
  /// Returns whether a job that is ready has failed.
  [[nodiscard]] bool failed() const noexcept { return error != nullptr || withdrawn.has_value(); }

  // Guarded by the scheduler's mutex.
  bool counted = false;       ///< counts against the worker's limit of jobs
  bool settled = false;       ///< the outcome is decided; the job can no longer be cancelled
  bool done = false;          ///< followers have been started; later ones start at once
  ComputationList followers;  ///< computations that start when this job is done
};

template <class Result>
class TypedJobRecord final : public JobRecord {
 public:
  TypedJobRecord() noexcept : JobRecord(&type_tag<Result>) {}

  std::optional<Stored<Result>> result;  ///< set once the job is ready and has not failed, until it is taken
};

/// Where a computation runs.
enum class CallSite {
  worker,   ///< on a thread of the worker
  drain,    ///< on the thread that calls `drain()`
  at_once,  ///< on the thread that completes the job which it follows
};

/// One piece of work, for at most one job.
class Computation {
 public:
  Computation() = default;
  /// Creates a computation that follows a job, whether that has failed or not.
  explicit Computation(CallSite its_site) noexcept : runs_after_errors(true), where(its_site) {}
  virtual ~Computation() = default;
  Computation(const Computation&) = delete;
  Computation& operator=(const Computation&) = delete;

  /// Computes and stores the result. Exceptions propagate.
  virtual void run(const Control& control) = 0;
  /// Moves the result to its job.
  virtual void deliver(JobRecord& /*its_job*/) {}
  /// Frees the request and its result.
  virtual void release() noexcept {}
  /// Called instead of `run` if the worker ends first. Jobs that wait for a result have already received an error.
  virtual void abandon() {}

  void report(double done) noexcept {
    double before = progress.load(std::memory_order_relaxed);
    while (done > before && !progress.compare_exchange_weak(before, std::min(done, 1.0), std::memory_order_relaxed)) {
    }
  }

  const bool runs_after_errors = false;  ///< runs even if the job that it follows has failed
  const CallSite where = CallSite::worker;

  std::atomic<double> progress{0.0};  ///< 0 to 1, never decreasing
  std::exception_ptr failure;         ///< error of the job that it follows; set before it starts

  // Guarded by the scheduler's mutex.
  TaskPriority priority = TaskPriority::normal;
  /// Time of posting or, if it follows a job, of becoming ready to start.
  std::chrono::steady_clock::time_point waiting_since{};
  std::shared_ptr<JobRecord> record;  ///< job that wants the result, until it is ready; may be null
  std::shared_ptr<JobRecord> parent;  ///< job that it follows, until that is done
  /// Stop source of the run, created by the thread that runs it, which removes it unless stop was requested.
  stop_source stop{nostopstate};
  bool stopping = false;                      ///< stop was requested: no job wants the result
  std::shared_ptr<Computation> next_to_stop;  ///< next in a list of computations to stop
  std::uint64_t bytes = 0;                    ///< bytes that count against the worker's limit
  ComputationList* list = nullptr;            ///< list of waiting or running computations, or of its parent's followers
  ComputationList::iterator place;            ///< position in that list
};

/// Result type of a request: that of calling it with a `Control`.
template <class Request>
using ResultOf = std::invoke_result_t<Request&, const Control&>;

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
      result_.emplace();
    } else {
      result_.emplace(std::invoke(*request_, control));
    }
  }

  void deliver(JobRecord& its_job) override {
    static_cast<TypedJobRecord<Result>&>(its_job).result.emplace(std::move(*result_));
  }

  void release() noexcept override {
    request_.reset();
    result_.reset();
  }

 private:
  std::optional<Request> request_;
  std::optional<Stored<Result>> result_;
};

/// Returns the bytes that a request counts against a worker's limit.
template <class Request>
std::uint64_t bytes_of(const Request& request) {
  if constexpr (requires { request.bytes(); }) {
    return request.bytes();
  } else {
    return 0;
  }
}

/// Arranges for `child` to run once `parent` is done, whatever its outcome; `job` (may be null) is the child's. Returns
/// false if the worker has ended; the job then has an error.
bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
            const std::shared_ptr<JobRecord>& job);

/// Waits until the job is ready. On a thread of its worker, runs the job if it has not started, after the jobs that it
/// follows.
void wait(const std::shared_ptr<JobRecord>& job);

/// Waits until the job is ready or the time is over, without running jobs. Polls at least once per millisecond.
void wait_for(const std::shared_ptr<JobRecord>& job, std::chrono::nanoseconds time);

/// Throws the error of a ready job, if it has one.
void throw_error_of(const JobRecord& job);

/// Throws `Error` (invalid_argument) for a job whose result was taken, or no job.
[[noreturn]] void throw_taken();

}  // namespace detail
}  // namespace welkin
