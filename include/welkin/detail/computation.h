// What a job is made of: the record that its caller holds, and the computation behind it. Users need
// worker.h.
//
// Nothing in here throws or catches, so that a host may compile it without exceptions: what a request throws is caught
// in the library, and kept in the job's record until somebody asks for it.
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

/// Which waiting job a worker starts next: the one of the higher priority, and of equals the older one.
enum class TaskPriority { low, normal, high };

namespace detail {

class WELKIN_HIDDEN Scheduler;
class Computation;
class JobRecord;

/// Memory for what a post makes and a thread of the worker lets go of. The system's allocator is kept out of that: a
/// thread of low rank that is put aside while it frees a block may hold a lock which the next allocation of the posting
/// thread takes. Blocks that come back are kept for later posts, in lists without locks, until a worker is destroyed.
/// Blocks of more than 4 KB are the system's at once. Throws std::bad_alloc.
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

/// A list whose nodes are made when a job is posted and then only change hands. So nothing is allocated when a job is
/// cancelled or ends.
using ComputationList = std::list<std::shared_ptr<Computation>, JobAllocator<std::shared_ptr<Computation>>>;
using JobKey = std::basic_string<char, std::char_traits<char>, JobAllocator<char>>;

/// A byte whose address stands for the type. It is not constant, because linkers may merge equal constants. Two shared
/// libraries may each have one for the same type; the type then counts as two.
template <class Type>
inline char type_tag = 0;

/// A result as it is stored.
template <class Result>
using Stored = std::conditional_t<std::is_void_v<Result>, std::monostate, Result>;

/// One posted job: what its handles and its worker share.
class JobRecord {
 public:
  explicit JobRecord(const void* its_result_type) noexcept : result_type(its_result_type) {}
  JobRecord(const JobRecord&) = delete;
  JobRecord& operator=(const JobRecord&) = delete;

  // Constant once the job is posted.
  const void* result_type;  ///< the address of its `type_tag`
  std::uint64_t id = 0;
  JobKey key;
  std::shared_ptr<Scheduler> scheduler;
  std::shared_ptr<Computation> computation;  ///< that gives the result

  // Written before `ready` is set, and read after it.
  std::exception_ptr error;            ///< why the computation gave no result
  std::optional<ErrorCode> withdrawn;  ///< why the job was given up; before, guarded by the scheduler's mutex
  std::atomic<bool> ready{false};
  /// Of a job that is ready.
  [[nodiscard]] bool failed() const noexcept { return error != nullptr || withdrawn.has_value(); }

  // Guarded by the scheduler's mutex.
  bool counted = false;       ///< against the worker's limit of jobs
  bool settled = false;       ///< the outcome is decided: it is too late to cancel the job
  bool done = false;          ///< its followers have been handed on; later ones are handed on at once
  ComputationList followers;  ///< that start when this job is done
};

template <class Result>
class TypedJobRecord final : public JobRecord {
 public:
  TypedJobRecord() noexcept : JobRecord(&type_tag<Result>) {}

  std::optional<Stored<Result>> result;  ///< there once the job is ready and has not failed, until it is taken
};

/// Where a computation runs.
enum class Place {
  worker,   ///< on a thread of the worker
  drain,    ///< on the thread that calls `drain()`
  at_once,  ///< on the thread that settles the job which it follows
};

/// One piece of work, for one job or for none.
class Computation {
 public:
  Computation() = default;
  /// A computation that follows a job whether that job failed or not.
  explicit Computation(Place its_place) noexcept : runs_after_errors(true), where(its_place) {}
  virtual ~Computation() = default;
  Computation(const Computation&) = delete;
  Computation& operator=(const Computation&) = delete;

  /// Does the work and keeps the result. What the work throws comes out.
  virtual void run(const Control& control) = 0;
  /// Moves the result into its job.
  virtual void deliver(JobRecord& /*its_job*/) {}
  /// Gives back the memory of the request and of its result.
  virtual void release() noexcept {}
  /// Takes the place of `run` when the worker ends first. Whatever waits for a result has got an error already.
  virtual void abandon() {}

  void report(double done) noexcept {
    double before = progress.load(std::memory_order_relaxed);
    while (done > before && !progress.compare_exchange_weak(before, std::min(done, 1.0), std::memory_order_relaxed)) {
    }
  }

  const bool runs_after_errors = false;  ///< also if the job that it follows has failed
  const Place where = Place::worker;

  std::atomic<double> progress{0.0};  ///< 0 to 1, never falling
  std::exception_ptr failure;         ///< the error of the job that it follows; set before it starts

  // Guarded by the scheduler's mutex.
  TaskPriority priority = TaskPriority::normal;
  /// When it was posted or, if it follows a job, became free to start.
  std::chrono::steady_clock::time_point waiting_since{};
  std::shared_ptr<JobRecord> record;  ///< of the job that wants the result, until it is ready; may be null
  std::shared_ptr<JobRecord> parent;  ///< the job that it follows, until that is done
  /// Of its run. The thread that runs it makes it, and takes it back if nobody has told the run to stop.
  stop_source stop{nostopstate};
  bool stopping = false;                      ///< the run has been told to stop: it is for nobody
  std::shared_ptr<Computation> next_to_stop;  ///< in a list of those that are being told
  std::uint64_t bytes = 0;                    ///< that count against the worker's limit
  ComputationList* list = nullptr;            ///< of those that wait, of those that run, or of its parent's followers
  ComputationList::iterator place;            ///< in that list
};

/// What a request gives: the result of calling it with a `Control`.
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

/// What a request counts against a worker's limit of bytes.
template <class Request>
std::uint64_t bytes_of(const Request& request) {
  if constexpr (requires { request.bytes(); }) {
    return request.bytes();
  } else {
    return 0;
  }
}

/// Has `child` run where it wants to once `parent` is done, whatever its outcome; `job` (may be null) is the child's.
/// False if that cannot be any more, because the worker has ended; the job has got an error then.
bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
            const std::shared_ptr<JobRecord>& job);

/// Waits until the job is ready. On a thread of its worker it runs the job here and now if it has not started, and
/// first what that follows.
void wait(const std::shared_ptr<JobRecord>& job);

/// Waits until the job is ready, at most so long, and does not help. It looks once a millisecond, or more often.
void wait_for(const std::shared_ptr<JobRecord>& job, std::chrono::nanoseconds time);

/// Throws why the job has no result, if that is so. It is ready.
void throw_error_of(const JobRecord& job);

/// Throws `Error` (invalid_argument), for a job whose result was taken or that is no job.
[[noreturn]] void throw_taken();

}  // namespace detail
}  // namespace welkin
