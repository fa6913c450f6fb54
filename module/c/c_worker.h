// A worker as C callers hold it.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <mutex>
#include <utility>
#include <variant>

#include "c/c_support.h"
#include "welkin/job.h"
#include "welkin/projection.h"
#include "welkin/welkin.h"
#include "welkin/worker.h"

struct welkin_worker {
  explicit welkin_worker(welkin::WorkerOptions options) : worker(std::move(options)) {}

  welkin::Worker worker;
};

// A posted job as C callers hold it: counted, asked any number of times, from any thread.

struct welkin_job {
 public:
  template <class Result>
  void adopt(welkin::Job<Result>& posted) noexcept {
    handle_ = static_cast<const welkin::JobHandle&>(posted);
    result_ = posted.future().share();
  }

  [[nodiscard]] const welkin::JobHandle& handle() const noexcept { return handle_; }

  /// Whether result or error are there.
  [[nodiscard]] bool ready() const;
  /// Waits for that, with the worker's help; or at most so long.
  void wait() const;
  void wait_for(std::chrono::nanoseconds time) const;

  /// WELKIN_NOT_READY, or how it ended. Throws std::bad_alloc.
  [[nodiscard]] const welkin::c_interface::Outcome& outcome() const;
  /// Of a job that is done and went well; null if it was a function's.
  [[nodiscard]] const welkin::Projection* projection() const;

  void retain() noexcept { references_.fetch_add(1, std::memory_order_relaxed); }
  void release() noexcept;

 private:
  using Function = std::shared_future<void>;
  using Projecting = std::shared_future<welkin::Projection>;

  welkin::JobHandle handle_;
  std::variant<Function, Projecting> result_;
  std::atomic<std::size_t> references_{1};

  mutable std::once_flag asked_;  ///< how it ended is looked up once: errors are thrown, which takes its time
  mutable welkin::c_interface::Outcome outcome_;
};

namespace welkin::c_interface {

/// Holds a reference.
class JobReference {
 public:
  /// A job that nothing is known of yet. Throws std::bad_alloc.
  JobReference() : job_(new welkin_job) {}
  ~JobReference() {
    if (job_ != nullptr) job_->release();
  }
  JobReference(const JobReference& other) noexcept : job_(other.job_) {
    if (job_ != nullptr) job_->retain();
  }
  JobReference(JobReference&& other) noexcept : job_(std::exchange(other.job_, nullptr)) {}
  JobReference& operator=(JobReference other) noexcept {
    std::swap(job_, other.job_);
    return *this;
  }

  [[nodiscard]] welkin_job* get() const noexcept { return job_; }
  welkin_job* operator->() const noexcept { return job_; }
  /// The reference goes over to the caller.
  [[nodiscard]] welkin_job* detach() noexcept { return std::exchange(job_, nullptr); }

 private:
  welkin_job* job_;
};

// Priorities are numbers around 0, the default.

/// Throws `Error` (invalid_argument) if there is none of that number.
[[nodiscard]] Priority priority_of(welkin_priority priority);

[[nodiscard]] welkin_priority number_of(Priority priority) noexcept;

// An engine's arena, lent through a function pointer.

/// As `WorkerOptions` wants it; empty if `enqueue` is null.
[[nodiscard]] std::function<void(std::function<void()>)> lent_arena(decltype(welkin_worker_options::enqueue) enqueue,
                                                                    void* user);

}  // namespace welkin::c_interface
