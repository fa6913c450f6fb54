// Letting jobs in: latest wins, limits hold.
#include "worker/scheduler.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <utility>

#include "jobs/activity.h"
#include "platform/file.h"
#include "platform/spin.h"
#include "platform/thread.h"
#include "welkin/worker.h"
#include "worker/thread_executor.h"

namespace welkin::detail {
namespace {

constexpr int kMaxThreads = 1024;

void check(const WorkerOptions& options) {
  const int threads = options.executor ? options.executor->concurrency() : options.threads;
  const int least = options.executor ? 1 : 0;
  if (threads < least || threads > kMaxThreads) {
    const char* what = options.executor ? "the executor's concurrency is " : "threads is ";
    throw Error(ErrorCode::invalid_argument, "WorkerOptions: " + (what + std::to_string(threads)) +
                                                 "; it must be from " + std::to_string(least) + " to " +
                                                 std::to_string(kMaxThreads));
  }
  if (options.max_jobs == 0) {
    throw Error(ErrorCode::invalid_argument, "WorkerOptions: max_jobs is 0; it must be at least 1");
  }
}

// A fork has a copy of it, as it was when it was made.
std::atomic<std::int64_t> sound_process{platform::process_number()};

/// Throws `Error` (stopped) in a fork that may have locks which nobody opens: a thread of the parent's may have been
/// anywhere, in our caches, in oneTBB's heap in the middle of an allocation, or asleep on a stack that a thread of this
/// process has now.
void require_no_lost_locks() {
  if (sound_process == platform::process_number()) return;
  if (jobs::activities != 0) {
    throw Error(
        ErrorCode::stopped,
        "this process was forked while its parent had a worker or a call of it computed, whose locks nobody opens "
        "here; fork before workers are made or after they are gone, or run another program (exec)");
  }
  sound_process = platform::process_number();
}

}  // namespace

Arrival::Arrival(std::shared_ptr<Computation> computation, std::shared_ptr<JobRecord> its_job,
                 std::shared_ptr<JobRecord> its_parent)
    : job(std::move(its_job)), parent(std::move(its_parent)), node{std::move(computation)} {
  if (job && !parent && !job->key.empty()) keyed.emplace(job->key, job);
}

Scheduler::Scheduler(WorkerOptions options) : options_(std::move(options)), process_(platform::process_number()) {
  check(options_);
  require_no_lost_locks();
  if (!options_.executor) own_threads_ = std::make_unique<ThreadExecutor>(options_);
  threads_ = own_threads_ ? own_threads_->concurrency() : options_.executor->concurrency();
  callers_may_look_ = leaves_a_processor(threads_);
}

Scheduler::~Scheduler() {
  for (Arrival* arrival = inbox_; arrival != nullptr;) delete std::exchange(arrival, arrival->next);
  give_back_job_memory();
}

void Scheduler::start() {
  if (own_threads_) own_threads_->start(shared_from_this());
}

bool Scheduler::is_forked() const noexcept { return platform::process_number() != process_; }

void Scheduler::require_own_process() const {
  if (!is_forked()) return;
  throw Error(ErrorCode::stopped, "this process is a fork of process " + std::to_string(process_) +
                                      ", which has the worker's threads; use the worker there, or make one here");
}

Scheduler::Lock Scheduler::locked() {
  require_own_process();
  // It is held for less than going to sleep takes, unless its holder is kept off the processors.
  constexpr std::chrono::microseconds kTime{2};
  Lock lock(mutex_, std::try_to_lock);
  if (!lock && !(callers_may_look_ && spin_until([&] { return lock.try_lock(); }, kTime))) lock.lock();
  return lock;
}

std::uint64_t Scheduler::next_id() noexcept {
  static std::atomic<std::uint64_t> last{0};
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

// The inbox.

Scheduler::Books::Books(Scheduler& scheduler, Lock lock) : scheduler_(scheduler), lock_(std::move(lock)) {
  if (lock_) scheduler_.empty_inbox(work);
}

Scheduler::Books::~Books() {
  while (lock_) {
    scheduler_.tell_jobs_of(work);
    scheduler_.plan_calls(work);
    work.news = std::exchange(scheduler_.news_, false);
    lock_.unlock();
    scheduler_.carry_out(work);
    // What came while the mutex was held, by this thread or by another one that `carry_out` has met.
    if (!scheduler_.inbox_has_something() || !lock_.try_lock()) return;
    scheduler_.empty_inbox(work);
  }
}

void Scheduler::put_in_inbox(std::unique_ptr<Arrival> arrival) {
  arrival->next = inbox_.load(std::memory_order_relaxed);
  while (!inbox_.compare_exchange_weak(arrival->next, arrival.get(), std::memory_order_acq_rel)) {
  }
  static_cast<void>(arrival.release());
  const Books books(*this, Lock(mutex_, std::try_to_lock));
}

/// After the mutex was unlocked. An exchange and not a load, so that it has a place in the order of the inbox's
/// changes: an arrival comes before it, and is seen, or after it, and then its thread sees the mutex unlocked.
bool Scheduler::inbox_has_something() noexcept {
  Arrival* none = nullptr;
  return !inbox_.compare_exchange_strong(none, nullptr, std::memory_order_acq_rel);
}

void Scheduler::empty_inbox(DeferredWork& work) {
  Arrival* newest = inbox_.exchange(nullptr, std::memory_order_acq_rel);
  Arrival* oldest = nullptr;
  while (newest != nullptr) {
    Arrival* const next = std::exchange(newest->next, oldest);
    oldest = std::exchange(newest, next);
  }
  while (oldest != nullptr) {
    const std::unique_ptr<Arrival> arrival(std::exchange(oldest, oldest->next));
    if (arrival->parent) {
      follow(*arrival, work);
    } else {
      admit(*arrival, work);
    }
  }
}

// Posts.

void Scheduler::submit(const std::shared_ptr<JobRecord>& job, const PostOptions& options, std::uint64_t bytes,
                       ComputationList follower) {
  require_own_process();
  const std::shared_ptr<Computation> posted = job->computation;
  job->id = next_id();
  job->key = options.key;
  job->scheduler = shared_from_this();
  posted->priority = options.priority;
  posted->waiting_since = Clock::now();
  posted->bytes = options.bytes.value_or(bytes);

  // All that may run out of memory comes before the books change.
  auto arrival = std::make_unique<Arrival>(posted, job, nullptr);
  if (!follower.empty()) hang(follower, job);
  if (!closed_ && reserve(posted->bytes)) return put_in_inbox(std::move(arrival));
  Books books(*this);
  if (const std::optional<ErrorCode> reason = reason_to_refuse(*arrival)) {
    refuse(*arrival, *reason, books.work);
  } else {
    admit(*arrival, books.work);
  }
}

/// Returns why a job that may be beyond the limits is refused. Without a reason, it has its place within them.
std::optional<ErrorCode> Scheduler::reason_to_refuse(const Arrival& arrival) {
  if (closed_) return ErrorCode::stopped;
  const std::uint64_t bytes = arrival.job->computation->bytes;
  if (bytes > options_.max_bytes) return ErrorCode::limit_exceeded;
  // Withdrawing a waiting job of the same key makes room at once.
  const auto newest = newest_.find(arrival.job->key);
  const bool frees = newest != newest_.end() && is_waiting(*newest->second->computation);
  const bool fits = reserve(bytes, frees ? 1 : 0, frees ? newest->second->computation->bytes : 0);
  return fits ? std::nullopt : std::optional(ErrorCode::queue_full);
}

/// A job with a place within the limits.
void Scheduler::admit(Arrival& arrival, DeferredWork& work) {
  const std::shared_ptr<JobRecord>& job = arrival.job;
  const std::shared_ptr<Computation>& posted = job->computation;
  job->counted = true;
  if (closed_) {
    bytes_ -= posted->bytes;
    settle(*job);
    return refuse(arrival, ErrorCode::stopped, work);
  }
  posted->record = job;
  enqueue(posted, arrival.node, false);
  ++work.startable;
  if (job->key.empty()) return;
  const auto newest = newest_.find(job->key);
  if (newest == newest_.end()) {
    newest_.insert(arrival.keyed.extract(arrival.keyed.begin()));
  } else {
    withdraw(std::exchange(newest->second, job), ErrorCode::replaced, work);
  }
}

void Scheduler::refuse(Arrival& arrival, ErrorCode reason, DeferredWork& work) {
  arrival.job->withdrawn = reason;
  arrival.job->settled = true;
  arrival.node.front()->record = arrival.job;
  work.ended.splice(work.ended.end(), arrival.node);
}

bool Scheduler::reserve(std::uint64_t bytes, std::size_t freed_jobs, std::uint64_t freed_bytes) noexcept {
  std::size_t jobs = jobs_;
  do {
    if (jobs - freed_jobs >= options_.max_jobs) return false;
  } while (!jobs_.compare_exchange_weak(jobs, jobs + 1));
  std::uint64_t held = bytes_;
  do {
    // More than the limit may be held, until the older job of a key is withdrawn.
    const std::uint64_t rest = held - freed_bytes;
    if (rest > options_.max_bytes || bytes > options_.max_bytes - rest) {
      --jobs_;
      return false;
    }
  } while (!bytes_.compare_exchange_weak(held, held + bytes));
  return true;
}

void Scheduler::settle(JobRecord& job) {
  job.settled = true;
  if (std::exchange(job.counted, false)) --jobs_;
  if (job.key.empty()) return;
  const auto newest = newest_.find(job.key);
  if (newest != newest_.end() && newest->second.get() == &job) newest_.erase(newest);
}

WorkerLoad Scheduler::load() {
  const Books books(*this);
  const Clock::time_point now = Clock::now();
  Clock::time_point oldest = now;
  for (const ComputationList& list : waiting_) {
    for (const std::shared_ptr<Computation>& computation : list) oldest = std::min(oldest, computation->waiting_since);
  }
  return {.waiting = waiting_count(),
          .running = running_.size(),
          .oldest_wait = now - oldest,
          .undrained = drained_.size(),
          .jobs = jobs_,
          .bytes = bytes_};
}

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

// What is called below may end with this worker gone, because a callback or a request may destroy it. So each call
// holds the scheduler.

void Worker::submit(const std::shared_ptr<detail::JobRecord>& job, const PostOptions& options, std::uint64_t bytes,
                    detail::ComputationList follower) {
  std::shared_ptr(scheduler_)->submit(job, options, bytes, std::move(follower));
}

std::size_t Worker::drain(std::chrono::nanoseconds budget) { return std::shared_ptr(scheduler_)->drain(budget); }

void Worker::terminate() { std::shared_ptr(scheduler_)->terminate(); }

void Worker::wait_until_idle() { std::shared_ptr(scheduler_)->wait_until_idle(); }

WorkerLoad Worker::load() const { return scheduler_->load(); }

int Worker::threads() const noexcept { return scheduler_->threads(); }

}  // namespace welkin
