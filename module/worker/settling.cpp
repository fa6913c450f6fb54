// Giving jobs up, and what follows when they are done.
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "worker/scheduler.h"
#include "worker/thread_executor.h"

namespace welkin::detail {
namespace {

const char* what_happened(ErrorCode reason) noexcept {
  switch (reason) {
    case ErrorCode::cancelled: return "cancelled by the caller";
    case ErrorCode::replaced: return "a newer request with the same key took its place";
    case ErrorCode::queue_full: return "the worker is at its limit of jobs or bytes in flight (WorkerOptions)";
    case ErrorCode::stopped: return "the worker was terminated";
    case ErrorCode::limit_exceeded: return "the request alone takes more than the worker's most_bytes (WorkerOptions)";
    default: return "given up";
  }
}

/// The error for a job's future, or that there was no memory for it.
std::exception_ptr error_of(const JobRecord& job, ErrorCode reason) noexcept {
  try {
    const std::string key = job.key.empty() ? "" : " (" + job.key + ")";
    return std::make_exception_ptr(Error(reason, "job " + std::to_string(job.id) + key + ": " + what_happened(reason)));
  } catch (...) {
    return std::current_exception();
  }
}

}  // namespace

bool Scheduler::withdraw(std::shared_ptr<JobRecord> job, ErrorCode reason, DeferredWork& deferred) {
  if (job->settled || job->withdrawn) return false;
  // A continuation that has not started gives up the job that it follows, which nobody else hears of.
  while (job && !job->settled && !job->withdrawn) {
    job->withdrawn = reason;
    const std::shared_ptr<Computation> computation = job->computation;
    std::shared_ptr<JobRecord> next;
    if (computation->jobs.size() > 1) {
      deferred.losers.splice(deferred.losers.end(), computation->jobs, job->place);
      settle(*job);
      update_priority(computation);
    } else if (computation->list == &running_) {
      deferred.stopping = computation;
    } else if (computation->list != nullptr) {
      next = computation->parent;
      settle(*job);
      deferred.losers.splice(deferred.losers.end(), computation->jobs);
      ComputationList node = taken_out(computation);
      deferred.discarded.splice(deferred.discarded.end(), node);
    } else {
      room_.notify_all();  // it still waits in `submit`, which looks
    }
    job = next;
  }
  return true;
}

void Scheduler::withdraw_all(const std::shared_ptr<Computation>& computation, ErrorCode reason,
                             DeferredWork& deferred) {
  while (!computation->jobs.empty()) {
    if (!withdraw(computation->jobs.front(), reason, deferred)) return;
  }
}

void Scheduler::settle(JobRecord& job) {
  job.settled = true;
  count_out(job);
}

void Scheduler::carry_out(DeferredWork deferred) {
  if (deferred.stopping) {
    // Whatever the request hung on its stop token runs here, and could not wait for the request's end.
    const ThreadExecutor::Service service(*this, ThreadExecutor::Role::bystander);
    deferred.stopping->stop.request_stop();
  }
  Orphans orphans;
  for (const std::shared_ptr<JobRecord>& job : deferred.losers) fail(*job, *job->withdrawn, orphans);
  for (const std::shared_ptr<Computation>& computation : deferred.discarded) computation->release();
  abandon(std::move(orphans));
}

void Scheduler::fail(JobRecord& job, ErrorCode reason, Orphans& orphans) {
  job.fail(error_of(job, reason));
  job.ready.store(true, std::memory_order_release);
  pass_on(job, orphans);
}

void Scheduler::pass_on(JobRecord& job, Orphans& orphans) {
  {
    const Lock lock(mutex_);
    job.done = true;
    DeliveryList& deliveries = abandoned_ ? orphans.deliveries : drained_;
    deliveries.splice(deliveries.end(), job.delivery);
    undrained_.store(drained_.size(), std::memory_order_release);
    if (job.continuation.empty()) return;
    const std::shared_ptr<Computation> next = job.continuation.front();
    next->parent = nullptr;
    if (closed_) {
      ComputationList node = taken_out(next);
      orphans.continuations.splice(orphans.continuations.end(), node);
      return;
    }
    enqueue(next, job.continuation, true);
  }
  call_for_hands();
}

void Scheduler::abandon(Orphans orphans) {
  const ComputationList ended = fail_orphans(orphans);
  let_go(ended, orphans.deliveries);
}

/// No code of the user's runs in here.
ComputationList Scheduler::fail_orphans(Orphans& orphans) {
  // One continuation after the other, not each inside its parent's end: a chain may be long. And all jobs get their
  // errors before any coroutine goes on: it may wait for one of them.
  ComputationList ended;
  while (!orphans.continuations.empty()) {
    const std::shared_ptr<Computation> computation = orphans.continuations.front();
    ended.splice(ended.end(), orphans.continuations, orphans.continuations.begin());
    JobList jobs;
    {
      const Lock lock(mutex_);
      jobs.splice(jobs.end(), computation->jobs);
      for (const std::shared_ptr<JobRecord>& job : jobs) {
        if (!job->withdrawn) job->withdrawn = ErrorCode::stopped;
        settle(*job);
      }
    }
    for (const std::shared_ptr<JobRecord>& job : jobs) fail(*job, *job->withdrawn, orphans);
  }
  return ended;
}

void Scheduler::let_go(const ComputationList& ended, const DeliveryList& late) {
  for (const std::shared_ptr<Computation>& computation : ended) computation->release();
  // A coroutine that throws out of itself has nobody to throw to here, as on a thread of the worker.
  const auto go_on = [](const auto& resume) {
    try {
      resume();
    } catch (...) {
    }
  };
  for (const std::shared_ptr<Computation>& computation : ended) go_on([&] { computation->abandon(); });
  for (const Delivery& delivery : late) {
    if (delivery.even_at_the_end) go_on(delivery.run);
  }
}

bool Scheduler::cancel(const std::shared_ptr<JobRecord>& job) {
  DeferredWork deferred;
  bool given_up = false;
  {
    const Lock lock(mutex_);
    given_up = withdraw(job, ErrorCode::cancelled, deferred);
  }
  carry_out(std::move(deferred));
  return given_up;
}

bool Scheduler::attach(JobRecord& parent, DeliveryList delivery) {
  const Lock lock(mutex_);
  if (parent.done && abandoned_) return false;
  DeliveryList& to = parent.done ? drained_ : parent.delivery;
  to.splice(to.end(), delivery);
  undrained_.store(drained_.size(), std::memory_order_release);
  return true;
}

bool Scheduler::attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
                       const std::shared_ptr<JobRecord>& job) {
  Orphans orphans;
  ComputationList node{child};
  if (job) job->place = child->jobs.insert(child->jobs.end(), job);
  {
    const Lock lock(mutex_);
    child->priority = parent->priority;
    if (job) {
      job->priority = parent->priority;
      job->scheduler = parent->scheduler;
      job->id = next_id();
    }
    if (!parent->done) {
      child->parent = parent;
      child->list = &parent->continuation;
      child->place = node.begin();
      parent->continuation.splice(parent->continuation.end(), node);
      return true;
    }
    if (!closed_) {
      enqueue(child, node, true);
    } else if (job) {
      orphans.continuations.splice(orphans.continuations.end(), node);
    } else {
      return false;
    }
  }
  if (!orphans.continuations.empty()) {
    abandon(std::move(orphans));
    return false;
  }
  call_for_hands();
  return true;
}

std::size_t Scheduler::drain(std::chrono::nanoseconds budget) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::microseconds kPause{20};
  const auto start = Clock::now();
  const auto spent = [&] { return Clock::now() - start >= budget; };
  std::size_t there = 0;
  for (std::size_t called = 0;; ++called) {
    // Without the mutex: most frames have nothing to drain.
    if (undrained_.load(std::memory_order_acquire) == 0 || (called > 0 && (called >= there || spent()))) return called;
    DeliveryList one;
    {
      // The mutex may be held by a thread of ours that more important ones keep off the processor: the budget is for
      // that too. Sleeping, and not spinning, gives it this one.
      Lock lock(mutex_, std::try_to_lock);
      while (!lock) {
        if (spent()) return called;
        std::this_thread::sleep_for(kPause);
        static_cast<void>(lock.try_lock());
      }
      if (called == 0) there = drained_.size();
      if (drained_.empty()) return called;
      one.splice(one.begin(), drained_, drained_.begin());
      undrained_.store(drained_.size(), std::memory_order_release);
    }
    one.front().run();
  }
}

void Scheduler::terminate() {
  Orphans left;
  {
    const Lock lock(mutex_);
    closed_ = true;
    for (ComputationList& list : waiting_) {
      while (!list.empty()) {
        const std::shared_ptr<Computation> computation = list.front();
        ComputationList node = taken_out(computation);
        left.continuations.splice(left.continuations.end(), node);
      }
    }
    for (const std::shared_ptr<Computation>& computation : running_) {
      for (const std::shared_ptr<JobRecord>& job : computation->jobs) {
        if (!job->withdrawn) job->withdrawn = ErrorCode::stopped;
      }
    }
    room_.notify_all();
    watch_.notify_all();
    ++ending_;
  }
  const ComputationList ended = fail_orphans(left);
  {
    const Lock lock(mutex_);
    --ending_;
    idle_.notify_all();
  }
  stop_running();
  let_go(ended, left.deliveries);
  executor_->dismiss();
  if (ThreadExecutor::serves(*this)) return;
  {
    Lock lock(mutex_);
    idle_.wait(lock, [&] { return running_.empty() && calling_ == 0 && ending_ == 0; });
  }
  executor_->join();
}

void Scheduler::stop_running() {
  const ThreadExecutor::Service service(*this, ThreadExecutor::Role::bystander);  // as in `carry_out`
  for (;;) {
    std::stop_source stop(std::nostopstate);
    {
      const Lock lock(mutex_);
      for (const std::shared_ptr<Computation>& computation : running_) {
        if (computation->stop.stop_requested()) continue;
        stop = computation->stop;
        break;
      }
    }
    if (!stop.stop_possible()) return;
    stop.request_stop();
  }
}

void Scheduler::abandon_rest() {
  Orphans rest;
  {
    const Lock lock(mutex_);
    abandoned_ = true;
    rest.deliveries.splice(rest.deliveries.end(), drained_);
    undrained_.store(0, std::memory_order_release);
  }
  abandon(std::move(rest));
  if (ThreadExecutor::serves(*this)) executor_->detach();
}

}  // namespace welkin::detail
