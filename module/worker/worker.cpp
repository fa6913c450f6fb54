// Workers, and the handles of their jobs.
#include "welkin/worker.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <string>
#include <thread>
#include <utility>

#include "jobs/control.h"
#include "worker/scheduler.h"

namespace welkin {
namespace detail {
namespace {

const char* what_happened(ErrorCode reason) noexcept {
  switch (reason) {
    case ErrorCode::cancelled: return jobs::kCancelled;
    case ErrorCode::replaced: return "a newer request with the same key took its place";
    case ErrorCode::queue_full: return "the worker is at its limit of jobs or bytes in flight (WorkerOptions)";
    case ErrorCode::stopped: return "the worker was terminated";
    case ErrorCode::limit_exceeded: return "the request alone takes more than the worker's max_bytes (WorkerOptions)";
    default: return "cancelled";
  }
}

}  // namespace

std::exception_ptr error_of(const JobRecord& job) noexcept {
  if (!job.withdrawn) return job.error;
  try {
    const std::string key = job.key.empty() ? "" : " (" + std::string(job.key) + ")";
    return std::make_exception_ptr(
        Error(*job.withdrawn, "job " + std::to_string(job.id) + key + ": " + what_happened(*job.withdrawn)));
  } catch (...) {
    return std::current_exception();
  }
}

bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
            const std::shared_ptr<JobRecord>& job) {
  return parent->scheduler->attach(parent, child, job);
}

void wait(const std::shared_ptr<JobRecord>& job) { job->scheduler->wait(*job); }

void wait_for(const std::shared_ptr<JobRecord>& job, std::chrono::nanoseconds time) {
  using std::chrono::nanoseconds;
  constexpr std::chrono::microseconds kShortest{20};
  constexpr std::chrono::milliseconds kLongest{1};
  const auto start = Scheduler::Clock::now();
  for (nanoseconds spent{0}; spent < time && !job->ready.load(std::memory_order_acquire);
       spent = Scheduler::Clock::now() - start) {
    const nanoseconds pause = std::clamp<nanoseconds>(spent / 8, kShortest, kLongest);
    std::this_thread::sleep_for(std::min(pause, time - spent));
  }
}

void throw_error_of(const JobRecord& job) {
  if (job.failed()) std::rethrow_exception(error_of(job));
}

void throw_taken() {
  throw Error(ErrorCode::invalid_argument,
              "the job's result was taken before, or there is no job; check valid() first");
}

}  // namespace detail

Worker::Worker(WorkerOptions options) : scheduler_(std::make_shared<detail::Scheduler>(std::move(options))) {
  try {
    scheduler_->start();
  } catch (...) {
    scheduler_->terminate();
    throw;
  }
}

Worker::~Worker() {
  scheduler_->terminate();
  scheduler_->abandon_rest();
}

// The calls below may end with this worker gone, because a callback or a request may destroy it. So each call holds the
// scheduler.

void Worker::submit(const std::shared_ptr<detail::JobRecord>& job, const PostOptions& options, std::uint64_t bytes,
                    detail::ComputationList follower) {
  std::shared_ptr(scheduler_)->submit(job, options, bytes, std::move(follower));
}

std::size_t Worker::drain(std::chrono::nanoseconds budget) { return std::shared_ptr(scheduler_)->drain(budget); }

void Worker::terminate() { std::shared_ptr(scheduler_)->terminate(); }

void Worker::wait_until_idle() { std::shared_ptr(scheduler_)->wait_until_idle(); }

WorkerLoad Worker::load() const { return scheduler_->load(); }

int Worker::threads() const noexcept { return scheduler_->threads(); }

std::optional<JobError> JobHandle::error() const {
  if (!ready() || !record_->failed()) return std::nullopt;
  try {
    std::rethrow_exception(detail::error_of(*record_));
  } catch (const Error& error) {
    return JobError{error.code(), error.what()};
  } catch (const std::exception& exception) {
    return JobError{std::nullopt, exception.what()};
  } catch (...) {
    return JobError{std::nullopt, "an exception of a type other than std::exception"};
  }
}

bool JobHandle::cancel() const { return record_ && record_->scheduler->cancel(record_); }

TaskPriority JobHandle::priority() const {
  return record_ ? record_->scheduler->priority_of(*record_) : TaskPriority::normal;
}

void JobHandle::set_priority(TaskPriority priority) const {
  if (record_) record_->scheduler->set_priority(*record_, priority);
}

}  // namespace welkin
