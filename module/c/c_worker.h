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

// Posting: what is handed over is given back whatever happens, and nothing fails any more once a job is posted.

/// A caller's post options; made before anything else that can fail, so that what is handed over has a keeper.
struct Posting {
  explicit Posting(const welkin_post_options* options)
      : given(options == nullptr ? welkin_post_options{} : read_known(options, "post")),
        handed_over(given.release, given.release_user) {
    if (options != nullptr) require_known(options, "post");
  }

  [[nodiscard]] PostOptions options() const {
    PostOptions wanted;
    wanted.priority = priority_of(given.priority);
    if (given.key != nullptr) wanted.key = given.key;
    if (given.bytes != 0) wanted.bytes = given.bytes;
    return wanted;
  }

  welkin_post_options given;
  HandedOver handed_over;
};

/// All that is needed later is made first: nothing may fail once the job is posted.
template <class Request>
void post(welkin_worker* worker, Request request, const Posting& posting, welkin_job** job) {
  JobReference reference;
  detail::DeliveryList delivery;
  if (posting.given.completed != nullptr) {
    const auto call = [reference, completed = posting.given.completed, user = posting.given.completed_user] {
      completed(reference.get(), user);
    };
    delivery.push_back({call, false});
  }
  auto posted = worker->worker.post(std::move(request), posting.options());
  reference->adopt(posted);
  if (!delivery.empty()) detail::attach(detail::JobAccess::record(posted), std::move(delivery));
  if (job != nullptr) *job = reference.detach();
}

/// Around every post: `body` gets the posting and makes the request.
template <class Body>
[[nodiscard]] welkin_status guarded_post(welkin_worker* worker, const welkin_post_options* options, welkin_job** job,
                                         const Body& body) noexcept {
  return guarded([&] {
    if (job != nullptr) *job = nullptr;
    Posting posting(options);
    require(worker, "worker");
    body(posting);
    return WELKIN_OK;
  });
}

}  // namespace welkin::c_interface
