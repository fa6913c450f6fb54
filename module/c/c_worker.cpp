#include "c/c_worker.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "c/c_projection.h"
#include "c/c_support.h"

namespace welkin::c_interface {
namespace {

static_assert(WELKIN_THREAD_PRIORITY_BELOW == static_cast<int>(ThreadPriority::below));
static_assert(WELKIN_THREAD_PRIORITY_NORMAL == static_cast<int>(ThreadPriority::normal));
static_assert(WELKIN_WHEN_FULL_REFUSE == static_cast<int>(WhenFull::refuse));
static_assert(WELKIN_WHEN_FULL_DROP_OLDEST == static_cast<int>(WhenFull::drop_oldest));

WorkerOptions worker_options(const welkin_worker_options* options) {
  const auto given = read_options(options, "options");
  WorkerOptions wanted;
  wanted.threads = given.threads;
  wanted.thread_priority = enumerator("thread_priority", given.thread_priority, ThreadPriority::normal);
  wanted.when_full = enumerator("when_full", given.when_full, WhenFull::drop_oldest);
  if (given.name != nullptr) wanted.name = given.name;
  wanted.lent_arena = lent_arena(given.enqueue, given.enqueue_user);
  if (given.most_jobs != 0) wanted.most_jobs = given.most_jobs;
  if (given.most_bytes != 0) wanted.most_bytes = given.most_bytes;
  return wanted;
}

std::chrono::nanoseconds budget(std::uint64_t nanoseconds) {
  constexpr auto kMost = static_cast<std::uint64_t>(std::chrono::nanoseconds::max().count());
  return std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(nanoseconds, kMost)));
}

}  // namespace
}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

welkin_status welkin_worker_create(const welkin_worker_options* options, welkin_worker** worker) {
  return guarded([&] {
    require(worker, "worker");
    *worker = nullptr;
    *worker = std::make_unique<welkin_worker>(worker_options(options)).release();
    return WELKIN_OK;
  });
}

void welkin_worker_destroy(welkin_worker* worker) {
  guarded([&] {
    const std::unique_ptr<welkin_worker> gone(worker);
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_terminate(welkin_worker* worker) {
  return guarded([&] {
    require(worker, "worker");
    worker->worker.terminate();
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_wait_until_idle(welkin_worker* worker) {
  return guarded([&] {
    require(worker, "worker");
    worker->worker.wait_until_idle();
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_drain(welkin_worker* worker, uint64_t budget_nanoseconds, uint64_t* called) {
  return guarded([&] {
    require(worker, "worker");
    const std::size_t count = worker->worker.drain(budget(budget_nanoseconds));
    if (called != nullptr) *called = count;
    return WELKIN_OK;
  });
}

welkin_status welkin_worker_get_load(const welkin_worker* worker, welkin_worker_load* load) {
  return guarded([&] {
    require(worker, "worker");
    const welkin::WorkerLoad now = worker->worker.load();
    welkin_worker_load values{};
    values.threads = worker->worker.threads();
    values.waiting = now.waiting;
    values.running = now.running;
    values.undrained = now.undrained;
    values.jobs = now.jobs;
    values.bytes = now.bytes;
    write_struct(load, values, "load");
    return WELKIN_OK;
  });
}

namespace {

constexpr std::chrono::hours kForever{24 * 365 * 100};  // what is longer would overflow a clock

const Outcome kNotReady{WELKIN_NOT_READY, {}};

/// What a question about the job returns, and what that leaves in `welkin_last_error`.
welkin_status report(const Outcome& outcome) noexcept {
  if (outcome.status == WELKIN_OK || outcome.status == WELKIN_NOT_READY) return outcome.status;
  return set_last_error(outcome.status, outcome.message);
}

/// The error of a job that is ready; null if it has a result.
std::exception_ptr error_in(const auto& future) {
  try {
    future.get();
    return nullptr;
  } catch (...) {
    return std::current_exception();
  }
}

}  // namespace

bool welkin_job::ready() const {
  return std::visit(
      [](const auto& result) { return result.wait_for(std::chrono::seconds(0)) == std::future_status::ready; },
      result_);
}

void welkin_job::wait() const {
  welkin::detail::help(welkin::detail::JobAccess::record(handle_));
  std::visit([](const auto& result) { result.wait(); }, result_);
}

void welkin_job::wait_for(std::chrono::nanoseconds time) const {
  std::visit([&](const auto& result) { static_cast<void>(result.wait_for(time)); }, result_);
}

const Outcome& welkin_job::outcome() const {
  if (!ready()) return kNotReady;
  std::call_once(asked_, [this] {
    const std::exception_ptr error = std::visit([](const auto& result) { return error_in(result); }, result_);
    if (error) outcome_ = outcome_of(error);
  });
  return outcome_;
}

const welkin::Projection* welkin_job::projection() const {
  const auto* result = std::get_if<Projecting>(&result_);
  return result == nullptr ? nullptr : &result->get();
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

welkin_status welkin_job_projection(const welkin_job* job, welkin_projection* projection) {
  return guarded([&] {
    require(job, "job");
    const Outcome& outcome = job->outcome();
    if (outcome.status != WELKIN_OK) return report(outcome);
    const welkin::Projection* light = job->projection();
    if (light == nullptr) refuse("the job runs a function of the caller's; it has no projection");
    write_projection(projection, *light);
    return outcome.status;
  });
}

welkin_status welkin_job_cancel(welkin_job* job, int32_t* given_up) {
  return guarded([&] {
    require(job, "job");
    const bool by_this_call = job->handle().cancel();
    if (given_up != nullptr) *given_up = by_this_call ? 1 : 0;
    return WELKIN_OK;
  });
}

welkin_status welkin_job_get_priority(const welkin_job* job, welkin_priority* priority) {
  return guarded([&] {
    require(job, "job");
    require(priority, "priority");
    *priority = number_of(job->handle().priority());
    return WELKIN_OK;
  });
}

welkin_status welkin_job_set_priority(welkin_job* job, welkin_priority priority) {
  return guarded([&] {
    require(job, "job");
    job->handle().set_priority(priority_of(priority));
    return WELKIN_OK;
  });
}

void welkin_job_retain(welkin_job* job) {
  if (job != nullptr) job->retain();
}

void welkin_job_release(welkin_job* job) {
  if (job != nullptr) job->release();
}

namespace welkin::c_interface {

Priority priority_of(welkin_priority priority) {
  switch (priority) {
    case WELKIN_PRIORITY_LOW: return Priority::low;
    case WELKIN_PRIORITY_NORMAL: return Priority::normal;
    case WELKIN_PRIORITY_HIGH: return Priority::high;
    default: refuse("priority is " + std::to_string(priority) + "; it must be -1 (low), 0 (normal) or 1 (high)");
  }
}

welkin_priority number_of(Priority priority) noexcept {
  switch (priority) {
    case Priority::low: return WELKIN_PRIORITY_LOW;
    case Priority::normal: return WELKIN_PRIORITY_NORMAL;
    case Priority::high: return WELKIN_PRIORITY_HIGH;
  }
  return WELKIN_PRIORITY_NORMAL;
}

namespace {

using Task = std::function<void()>;

/// What the engine calls: once, so the task goes with it. Nothing may be thrown into the engine.
void run_task(void* argument) noexcept {
  const std::unique_ptr<Task> task(static_cast<Task*>(argument));
  try {
    (*task)();
  } catch (
      ...) {  // NOLINT(bugprone-empty-catch): a worker's tasks throw nothing; what requests throw is in the futures
  }
}

}  // namespace

std::function<void(Task)> lent_arena(decltype(welkin_worker_options::enqueue) enqueue, void* user) {
  if (enqueue == nullptr) return {};
  return [enqueue, user](Task task) {
    auto argument = std::make_unique<Task>(std::move(task));
    enqueue(user, &run_task, argument.release());
  };
}

}  // namespace welkin::c_interface
