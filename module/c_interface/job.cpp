#include "c_interface/job.h"

#include <chrono>
#include <cstdint>

#include "c_interface/job_priority.h"
#include "c_interface/projection_result.h"

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace)

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
