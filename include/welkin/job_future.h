// A std::future of a job, for code that waits for futures of several libraries.
//
//   std::future<welkin::Projection> light = welkin::future_of(worker.post(welkin::ProjectCubemap{std::move(image)}));
//
// This header needs exceptions, as <future> does; job.h does not.
#pragma once

#include <future>
#include <memory>
#include <type_traits>
#include <utility>

#include "welkin/core.h"
#include "welkin/job.h"

namespace WELKIN_EXPORT welkin {

namespace detail {

/// Fulfils a promise, on the thread that settles the job.
template <class Result>
class PromiseKeeper final : public Computation {
 public:
  explicit PromiseKeeper(Job<Result> job) : job_(std::move(job)) {
    where = Place::at_once;
    runs_after_errors = true;
  }

  [[nodiscard]] std::future<Result> future() { return promise_.get_future(); }

  void run(const Control&) override {
    if (failure) {
      promise_.set_exception(failure);
    } else if constexpr (std::is_void_v<Result>) {
      promise_.set_value();
    } else {
      promise_.set_value(job_.get());
    }
  }

 private:
  Job<Result> job_;
  std::promise<Result> promise_{std::allocator_arg, JobAllocator<Result>()};
};

}  // namespace detail

/// A `std::future` of the job's result or error. The job is taken: nobody else can take its result, and a copy of its
/// handle, made before, still cancels it. The future must not be waited for inside a request of the same worker,
/// because it does not help as `Job::get()` does (docs/guides/worker.md). Throws `Error` (invalid_argument) if the
/// result was taken before, and std::bad_alloc.
template <class Result>
[[nodiscard]] std::future<Result> future_of(Job<Result> job) {
  const auto record = detail::JobAccess::record(job);
  const auto keeper =
      detail::make_shared_in_job_memory<detail::PromiseKeeper<Result>>(detail::JobAccess::take_over(job));
  std::future<Result> future = keeper->future();
  detail::attach(record, keeper, nullptr);
  return future;
}

}  // namespace welkin
