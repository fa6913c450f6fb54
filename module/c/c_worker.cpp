#include "c/c_worker.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "c/c_support.h"

namespace welkin::c_interface {
namespace {

ThreadPriority thread_priority_of(welkin_thread_priority priority) {
  static_assert(WELKIN_THREAD_PRIORITY_BELOW_NORMAL == 1 && WELKIN_THREAD_PRIORITY_NORMAL == 2);
  image::require_range("thread_priority", priority, WELKIN_THREAD_PRIORITY_DEFAULT, WELKIN_THREAD_PRIORITY_IDLE);
  const std::array priorities{WorkerOptions().thread_priority, ThreadPriority::below_normal, ThreadPriority::normal,
                              ThreadPriority::idle};
  return priorities[static_cast<std::size_t>(priority)];
}

/// An executor on an engine's threads, through a function pointer.
class FunctionExecutor final : public Executor {
 public:
  FunctionExecutor(decltype(welkin_worker_options::enqueue) function, void* user, int concurrency) noexcept
      : enqueue_(function), user_(user), concurrency_(concurrency) {}

  [[nodiscard]] int concurrency() const noexcept override { return concurrency_; }
  void enqueue(void (*run)(void* job), void* job) override {
    // A function that ends its thread may have taken the task or not; assuming that it did is harmless.
    static_cast<void>(returns([&] { enqueue_(user_, run, job); }));
  }

 private:
  decltype(welkin_worker_options::enqueue) enqueue_;
  void* user_;
  int concurrency_;
};

std::chrono::nanoseconds budget(std::uint64_t nanoseconds) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::chrono::nanoseconds::max().count());
  return std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(nanoseconds, kMax)));
}

}  // namespace

WorkerOptions worker_options(const welkin_worker_options* options) {
  const auto given = read_options(options, "options");
  WorkerOptions wanted;
  wanted.threads = given.threads;
  wanted.thread_priority = thread_priority_of(given.thread_priority);
  if (given.name != nullptr) wanted.name = given.name;
  if (given.enqueue != nullptr) {
    const int concurrency = given.threads == 0 ? available_threads() : given.threads;
    wanted.executor = std::make_shared<FunctionExecutor>(given.enqueue, given.enqueue_user, concurrency);
  }
  if (given.max_jobs != 0) wanted.max_jobs = given.max_jobs;
  if (given.max_bytes != 0) wanted.max_bytes = given.max_bytes;
  return wanted;
}

}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

welkin_status welkin_worker_create(const welkin_worker_options* options, welkin_worker** worker) {
  return guarded_making(worker, "worker", [&] { return new welkin_worker(worker_options(options)); });
}

void welkin_worker_destroy(welkin_worker* worker) { destroy(worker); }

welkin_status welkin_worker_terminate(welkin_worker* worker) {
  return guarded([&] {
    require(worker, "worker");
    worker->worker.terminate();
  });
}

welkin_status welkin_worker_wait_until_idle(welkin_worker* worker) {
  return guarded([&] {
    require(worker, "worker");
    worker->worker.wait_until_idle();
  });
}

welkin_status welkin_worker_drain(welkin_worker* worker, uint64_t budget_nanoseconds, uint64_t* called) {
  return guarded_as_called([&] {
    require(worker, "worker");
    const std::size_t count = worker->worker.drain(budget(budget_nanoseconds));
    if (called != nullptr) *called = count;
  });
}

namespace {

/// A caller's function, as a request. No two are equal.
class FunctionRequest {
 public:
  using Run = welkin_status (*)(void* user, const welkin_control* control);

  FunctionRequest(Run run, void* user, HandedOver used) noexcept : run_(run), user_(user), used_(std::move(used)) {}

  void operator()(const welkin::Control& control) const {
    const welkin_control steering{control};
    clear_last_error();
    welkin_status status = WELKIN_OK;
    if (!returns([&] { status = run_(user_, &steering); })) refuse_thread_exit("the function");
    if (status == WELKIN_OK) return;
    if (status == WELKIN_NOT_READY) {
      throw StatusError(WELKIN_INTERNAL,
                        "the function returned WELKIN_NOT_READY, which is not a valid result of a job");
    }
    // A call inside that failed with this status explains the function's failure.
    if (status == last_error_status()) throw StatusError(status, welkin_last_error());
    throw StatusError(status, "the function returned " + std::to_string(status));
  }

 private:
  Run run_;
  void* user_;
  HandedOver used_;
};

}  // namespace

welkin_status welkin_post_function(welkin_worker* worker,
                                   welkin_status (*run)(void* run_user, const welkin_control* control), void* run_user,
                                   const welkin_post_options* post, welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    if (run == nullptr) refuse("run is null");
    return FunctionRequest(run, run_user, std::move(posting.handed_over));
  });
}

namespace {

constexpr std::chrono::hours kForever{24 * 365 * 100};  // a longer duration would overflow a clock

const Outcome kNotReady{WELKIN_NOT_READY, {}};

}  // namespace

welkin_status welkin::c_interface::report(const Outcome& outcome) noexcept {
  if (outcome.status == WELKIN_OK || outcome.status == WELKIN_NOT_READY) return outcome.status;
  return set_last_error(outcome.status, outcome.message);
}

void welkin_job::wait() const { welkin::detail::wait(welkin::detail::JobAccess::record(handle_)); }

void welkin_job::wait_for(std::chrono::nanoseconds time) const {
  welkin::detail::wait_for(welkin::detail::JobAccess::record(handle_), time);
}

const Outcome& welkin_job::outcome() const {
  if (!handle_.ready()) return kNotReady;
  std::call_once(asked_, [this] {
    if (!record().failed()) return;
    try {
      welkin::detail::throw_error_of(record());
    } catch (...) {
      outcome_ = outcome_of(std::current_exception());
    }
  });
  return outcome_;
}

void welkin_job::release() noexcept {
  if (references_.fetch_sub(1, std::memory_order_acq_rel) == 1) delete this;
}

uint64_t welkin_job_id(const welkin_job* job) { return job == nullptr ? 0 : job->handle().id(); }

welkin_status welkin_job_poll(const welkin_job* job, double* progress) {
  return guarded([&] {
    require(job, "job");
    const Outcome& outcome = job->outcome();
    if (progress != nullptr) *progress = outcome.status == WELKIN_OK ? 1.0 : job->handle().progress();
    return report(outcome);
  });
}

welkin_status welkin_job_wait(const welkin_job* job, uint64_t timeout_nanoseconds) {
  return guarded([&] {
    require(job, "job");
    constexpr auto kLongest = static_cast<std::uint64_t>(std::chrono::nanoseconds(kForever).count());
    if (timeout_nanoseconds >= kLongest) {
      job->wait();
    } else {
      job->wait_for(std::chrono::nanoseconds(static_cast<std::int64_t>(timeout_nanoseconds)));
    }
    return report(job->outcome());
  });
}

welkin_status welkin_job_cancel(welkin_job* job, int32_t* cancelled) {
  return guarded([&] {
    require(job, "job");
    const bool by_this_call = job->handle().cancel();
    if (cancelled != nullptr) *cancelled = by_this_call ? 1 : 0;
  });
}

welkin_status welkin_job_set_priority(welkin_job* job, welkin_priority priority) {
  return guarded([&] {
    require(job, "job");
    job->handle().set_priority(priority_of(priority));
  });
}

void welkin_job_retain(welkin_job* job) {
  if (job != nullptr) job->retain();
}

void welkin_job_release(welkin_job* job) {
  if (job != nullptr) job->release();
}

namespace welkin::c_interface {

TaskPriority priority_of(welkin_priority priority) {
  switch (priority) {
    case WELKIN_PRIORITY_LOW: return TaskPriority::low;
    case WELKIN_PRIORITY_NORMAL: return TaskPriority::normal;
    case WELKIN_PRIORITY_HIGH: return TaskPriority::high;
    default: refuse("priority is " + std::to_string(priority) + "; it must be -1 (low), 0 (normal) or 1 (high)");
  }
}

}  // namespace welkin::c_interface
