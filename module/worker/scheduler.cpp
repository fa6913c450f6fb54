// Noticing that all threads sleep while computations wait.
//
// A request or a continuation may wait on the future of another job. If all of a worker's threads do that, nobody is
// left to run what they wait for; a plain std::future gives no hint of it. So one thread looks, every few milliseconds
// and only while computations wait: if none has started or ended and all threads sleep, it has one run outside the
// arena. Threads that are merely kept off the processor by more important ones do not sleep.
#include "worker/scheduler.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "platform/thread.h"
#include "welkin/worker.h"
#include "worker/thread_executor.h"

namespace welkin::detail {
namespace {

constexpr int kMostThreads = 1024;

const WorkerOptions& checked(const WorkerOptions& options) {
  if (options.threads < 0 || options.threads > kMostThreads) {
    throw Error(ErrorCode::invalid_argument, "WorkerOptions: threads is " + std::to_string(options.threads) +
                                                 "; it must be from 0 to " + std::to_string(kMostThreads));
  }
  if (options.most_jobs == 0) {
    throw Error(ErrorCode::invalid_argument, "WorkerOptions: most_jobs is 0; it must be at least 1");
  }
  return options;
}

}  // namespace

Scheduler::Scheduler(WorkerOptions options)
    : options_(std::move(options)), executor_(std::make_unique<ThreadExecutor>(checked(options_))) {}

Scheduler::~Scheduler() = default;

void Scheduler::start() { executor_->start(shared_from_this()); }

WorkerLoad Scheduler::load() const {
  const Lock lock(mutex_);
  return {.waiting = waiting_[0].size() + waiting_[1].size() + waiting_[2].size(),
          .running = running_.size(),
          .undrained = drained_.size(),
          .jobs = jobs_,
          .bytes = bytes_};
}

std::uint64_t Scheduler::next_id() noexcept {
  static std::atomic<std::uint64_t> last{0};
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

int Scheduler::threads() const noexcept { return executor_->threads(); }

}  // namespace welkin::detail

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

namespace welkin::detail {
namespace {

// The first look is early: a thread that was called may be kept by another job's task while a free one sleeps on.
constexpr std::chrono::milliseconds kFirstLook{1};
constexpr std::chrono::milliseconds kLook{10};
constexpr int kLooksBeforeRescue = 2;
// A lent arena in which nothing of ours runs may simply be busy: that cannot be told from being stuck.
constexpr int kLooksBeforeRescueFromLent = 10;

}  // namespace

bool Scheduler::nobody_moves() const {
  std::vector<long> threads;
  {
    const Lock lock(mutex_);
    for (const std::shared_ptr<Computation>& computation : running_) threads.push_back(computation->thread);
  }
  return executor_->all_asleep() && std::all_of(threads.begin(), threads.end(), asleep);
}

void Scheduler::watch() {
  Lock lock(mutex_);
  while (!closed_) {
    watch_.wait(lock, [&] { return closed_ || any_waiting(); });
    watching_ = true;
    int still = 0;
    std::chrono::milliseconds pause = kFirstLook;
    while (!closed_ && any_waiting()) {
      const std::uint64_t before = events_;
      const bool runs = !running_.empty();
      watch_.wait_for(lock, std::exchange(pause, kLook), [&] { return closed_; });
      if (closed_) break;
      const bool moved = events_ != before;
      lock.unlock();
      try {
        still = !moved && nobody_moves() ? still + 1 : 0;
        executor_->call_all();
        if (still >= (executor_->lent() && !runs ? kLooksBeforeRescueFromLent : kLooksBeforeRescue)) {
          still = 0;
          executor_->rescue(shared_from_this());
        }
      } catch (const std::bad_alloc&) {
        // The next look may do better.
      } catch (const std::system_error&) {
      }
      lock.lock();
    }
    watching_ = false;
  }
}

// Letting jobs in: latest wins, equal ones share a run, limits hold.

void Scheduler::submit(const std::shared_ptr<JobRecord>& job, const PostOptions& options, std::uint64_t bytes) {
  const std::shared_ptr<Computation> posted = job->computation;
  job->id = next_id();
  job->key = options.key;
  job->scheduler = shared_from_this();
  job->priority = options.priority;
  posted->priority = options.priority;
  posted->bytes = options.bytes.value_or(bytes);

  // All that may run out of memory comes before the books change.
  PendingPost pending{job};
  DeferredWork deferred;
  Admission admission{};
  {
    Lock lock(mutex_);
    try {
      while ((admission = decide(pending, deferred)) == Admission::wait) {
        if (deferred.losers.empty() && !deferred.stopping) {
          room_.wait(lock);
        } else {
          lock.unlock();
          carry_out(std::exchange(deferred, {}));
          lock.lock();
        }
      }
    } catch (...) {
      forget(*job);
      throw;
    }
  }
  carry_out(std::move(deferred));
  if (admission == Admission::refused) {
    posted->release();
    Orphans none;  // nobody knows of the job yet
    fail(*job, *job->withdrawn, none);
  } else if (job->computation == posted) {
    call_for_hands();
  } else {
    posted->release();
  }
}

Scheduler::Admission Scheduler::decide(PendingPost& pending, DeferredWork& deferred) {
  const std::shared_ptr<JobRecord>& job = pending.job;
  const std::uint64_t bytes = job->computation->bytes;
  const auto refuse = [&](ErrorCode reason) {
    forget(*job);
    job->withdrawn = reason;
    job->settled = true;
    return Admission::refused;
  };
  if (closed_) return refuse(ErrorCode::stopped);
  if (job->withdrawn) return refuse(*job->withdrawn);  // a newer job of its key came while it waited for room
  if (bytes > options_.most_bytes) return refuse(ErrorCode::limit_exceeded);

  const std::shared_ptr<Computation> equal = find_equal(pending);
  std::shared_ptr<JobRecord> older;
  if (!job->key.empty()) {
    older = newest_.try_emplace(job->key).first->second;
    if (older == job) older = nullptr;
  }

  // What giving up the older job frees at once.
  const bool older_goes =
      older && !older->withdrawn && older->computation->jobs.size() == 1 && is_waiting(*older->computation);
  const std::size_t freed_jobs = older_goes ? 1 : 0;
  const std::uint64_t freed_bytes = older_goes ? older->computation->bytes : 0;
  const std::uint64_t more_bytes = equal ? 0 : bytes;
  if (!fits(freed_jobs, more_bytes, freed_bytes)) {
    switch (options_.when_full) {
      case WhenFull::wait:
        if (ThreadExecutor::serves(*this)) break;
        if (!job->key.empty()) newest_[job->key] = job;
        if (older) withdraw(older, ErrorCode::replaced, deferred);
        return Admission::wait;
      case WhenFull::refuse: return refuse(ErrorCode::queue_full);
      case WhenFull::drop_oldest: {
        const std::array<const Computation*, 2> spared{equal.get(), older_goes ? older->computation.get() : nullptr};
        if (!make_room(*job, freed_jobs, more_bytes, freed_bytes, spared, deferred)) {
          return refuse(ErrorCode::queue_full);
        }
      }
    }
  }
  admit(pending, equal, older, deferred);
  return Admission::admitted;
}

void Scheduler::admit(PendingPost& pending, const std::shared_ptr<Computation>& equal,
                      const std::shared_ptr<JobRecord>& older, DeferredWork& deferred) {
  const std::shared_ptr<JobRecord>& job = pending.job;
  if (equal) job->computation = equal;
  job->computation->jobs.splice(job->computation->jobs.end(), pending.job_node);
  job->counted = true;
  ++jobs_;
  if (equal) {
    if (job->priority > equal->priority) rank(equal, job->priority);
  } else {
    bytes_ += job->computation->bytes;
    enqueue(job->computation, pending.node, false);
    if (!pending.entry.empty()) {
      job->computation->entry = shareable_.insert(pending.entry.extract(pending.entry.begin()));
      job->computation->indexed = true;
    }
  }
  if (!job->key.empty()) newest_.find(job->key)->second = job;
  // Last: if it is the older job's run that this one shares, that must not stop.
  if (older) withdraw(older, ErrorCode::replaced, deferred);
}

std::shared_ptr<Computation> Scheduler::find_equal(const PendingPost& pending) const {
  if (pending.entry.empty()) return nullptr;
  const auto [hash, computation] = *pending.entry.begin();
  const auto [first, last] = shareable_.equal_range(hash);
  for (auto candidate = first; candidate != last; ++candidate) {
    // One that was told to stop gives no result.
    if (candidate->second->jobs.front()->withdrawn) continue;
    if (candidate->second->list == &running_ && !computation->joinable_while_running()) continue;
    if (candidate->second->equals(*computation)) return candidate->second;
  }
  return nullptr;
}

void Scheduler::close(Computation& computation) {
  if (!computation.indexed) return;
  shareable_.erase(computation.entry);
  computation.indexed = false;
}

bool Scheduler::fits(std::size_t freed_jobs, std::uint64_t bytes, std::uint64_t freed_bytes) const noexcept {
  // What is there may be beyond the limits: posts from the worker's own threads are let in.
  const std::uint64_t rest = bytes_ - freed_bytes;
  return jobs_ - freed_jobs < options_.most_jobs && rest <= options_.most_bytes && bytes <= options_.most_bytes - rest;
}

bool Scheduler::make_room(const JobRecord& job, std::size_t freed_jobs, std::uint64_t bytes, std::uint64_t freed_bytes,
                          const std::array<const Computation*, 2>& spared, DeferredWork& deferred) {
  // Of those that may go, in the order in which they would: how many it takes.
  const auto each = [&](auto take) {
    for (int priority = 0; priority <= static_cast<int>(job.priority); ++priority) {
      ComputationList& list = waiting(static_cast<Priority>(priority));
      for (auto place = list.begin(); place != list.end();) {
        const std::shared_ptr<Computation> candidate = *place++;
        const bool counted = !candidate->jobs.empty() && candidate->jobs.front()->counted;
        const bool kept = candidate.get() == spared[0] || candidate.get() == spared[1];
        if (counted && !kept && !take(candidate)) return;
      }
    }
  };
  std::size_t number = 0;
  bool enough = false;
  each([&](const std::shared_ptr<Computation>& candidate) {
    freed_jobs += candidate->jobs.size();
    freed_bytes += candidate->bytes;
    enough = fits(freed_jobs, bytes, freed_bytes);
    ++number;
    return !enough;
  });
  if (!enough) return false;
  each([&](const std::shared_ptr<Computation>& candidate) {
    withdraw_all(candidate, ErrorCode::queue_full, deferred);
    return --number > 0;
  });
  return true;
}

void Scheduler::forget(const JobRecord& job) {
  const auto entry = newest_.find(job.key);
  if (entry != newest_.end() && (entry->second == nullptr || entry->second.get() == &job)) newest_.erase(entry);
}

void Scheduler::count_out(JobRecord& job) {
  if (job.counted) {
    --jobs_;
    job.counted = false;
  }
  if (!job.key.empty()) forget(job);
  room_.notify_all();
}

}  // namespace welkin::detail
