#include "welkin/worker.h"

#include <utility>

#include "worker/scheduler.h"

namespace welkin {

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

// What is called below may end with this worker gone: a callback or a request may destroy it.

void Worker::submit(const std::shared_ptr<detail::JobRecord>& job, const PostOptions& options, std::uint64_t bytes) {
  const auto scheduler = scheduler_;
  scheduler->submit(job, options, bytes);
}

std::size_t Worker::drain(std::chrono::nanoseconds budget) {
  const auto scheduler = scheduler_;
  return scheduler->drain(budget);
}

void Worker::terminate() {
  const auto scheduler = scheduler_;
  scheduler->terminate();
}

void Worker::wait_until_idle() { scheduler_->wait_until_idle(); }

WorkerLoad Worker::load() const { return scheduler_->load(); }

int Worker::threads() const noexcept { return scheduler_->threads(); }

bool JobHandle::cancel() const { return record_->scheduler->cancel(record_); }

Priority JobHandle::priority() const { return record_->scheduler->priority_of(*record_); }

void JobHandle::set_priority(Priority priority) const { record_->scheduler->set_priority(*record_, priority); }

namespace detail {

bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
            const std::shared_ptr<JobRecord>& job) {
  return parent->scheduler->attach(parent, child, job);
}

bool attach(const std::shared_ptr<JobRecord>& parent, DeliveryList delivery) {
  return parent->scheduler->attach(*parent, std::move(delivery));
}

void help(const std::shared_ptr<JobRecord>& job) { job->scheduler->help(*job); }

}  // namespace detail
}  // namespace welkin
