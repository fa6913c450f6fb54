// Letting jobs in: latest wins, equal ones share a run, limits hold.
#include "worker/scheduler.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <utility>

#include "platform/file.h"
#include "platform/spin.h"
#include "platform/thread.h"
#include "welkin/worker.h"
#include "worker/fork_guard.h"
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

}  // namespace

Arrival::Arrival(std::shared_ptr<Computation> computation, std::shared_ptr<JobRecord> its_job,
                 std::shared_ptr<JobRecord> its_parent)
    : job(std::move(its_job)), parent(std::move(its_parent)), node{std::move(computation)} {
  if (!job) return;
  job_node.push_back(job);
  job->place = job_node.begin();
  if (parent) return;
  if (node.front()->kind != nullptr) shareable.emplace(node.front()->hash(), node.front());
  if (!job->key.empty()) keyed.emplace(job->key, job);
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
    scheduler_.end_losers(work);
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
      admit(*arrival, find_equal(*arrival), work);
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
  job->priority = options.priority;
  posted->priority = options.priority;
  posted->waiting_since = Clock::now();
  posted->bytes = options.bytes.value_or(bytes);

  // All that may run out of memory comes before the books change.
  auto arrival = std::make_unique<Arrival>(posted, job, nullptr);
  if (!follower.empty()) hang(follower, job);
  if (!closed_ && reserve(posted->bytes)) return put_in_inbox(std::move(arrival));
  Admission admission{};
  wait_for([&] {
    Books books(*this);
    admission = decide(*arrival, books.work);
    return admission != Admission::wait;
  });
}

/// For a job that may be beyond the limits.
Scheduler::Admission Scheduler::decide(Arrival& arrival, DeferredWork& work) {
  const std::shared_ptr<JobRecord>& job = arrival.job;
  const std::uint64_t bytes = job->computation->bytes;
  const auto refused = [&](ErrorCode reason) {
    forget(*job);
    refuse(arrival, reason, work);
    return Admission::refused;
  };
  if (closed_) return refused(ErrorCode::stopped);
  if (job->withdrawn) return refused(*job->withdrawn);  // a newer job of its key came while it waited for room
  if (bytes > options_.max_bytes) return refused(ErrorCode::limit_exceeded);

  const std::shared_ptr<Computation> equal = find_equal(arrival);
  const auto newest = newest_.find(job->key);
  const std::shared_ptr<JobRecord> older = newest == newest_.end() || newest->second == job ? nullptr : newest->second;
  if (!make_room(arrival, equal.get(), older.get(), work)) {
    if (options_.overflow != OverflowPolicy::wait) return refused(ErrorCode::queue_full);
    if (!ThreadRole::has_any(*this)) {
      // It is the newest of its key already.
      if (older) {
        newest->second = job;
        withdraw(older, ErrorCode::replaced, work);
      } else if (!arrival.keyed.empty()) {
        newest_.insert(arrival.keyed.extract(arrival.keyed.begin()));
      }
      return Admission::wait;
    }
    ++jobs_;
    bytes_ += bytes;
  }
  admit(arrival, equal, work);
  return Admission::admitted;
}

/// True if the job has a place now, maybe because others were dropped for it.
bool Scheduler::make_room(const Arrival& arrival, const Computation* equal, const JobRecord* older,
                          DeferredWork& work) {
  const JobRecord& job = *arrival.job;
  const std::uint64_t bytes = equal != nullptr ? 0 : job.computation->bytes;
  // What giving up the older job frees at once.
  const Computation* const going =
      older != nullptr && !older->withdrawn && older->computation->jobs.size() == 1 && is_waiting(*older->computation)
          ? older->computation.get()
          : nullptr;
  const std::size_t freed_jobs = going != nullptr ? 1 : 0;
  const std::uint64_t freed_bytes = going != nullptr ? going->bytes : 0;
  const auto reserved = [&] {
    if (!reserve(bytes, freed_jobs, freed_bytes)) return false;
    bytes_ += job.computation->bytes - bytes;  // `admit` gives back what an equal one spares
    return true;
  };
  if (reserved()) return true;
  if (options_.overflow != OverflowPolicy::drop_oldest) return false;

  // Those that may go, in the order in which they would. Nobody is dropped in vain.
  const auto each = [&](auto take) {
    for (int priority = 0; priority <= static_cast<int>(job.priority); ++priority) {
      ComputationList& list = waiting(static_cast<TaskPriority>(priority));
      for (auto place = list.begin(); place != list.end();) {
        const std::shared_ptr<Computation> candidate = *place++;
        const bool counted = !candidate->jobs.empty() && candidate->jobs.front()->counted;
        if (counted && candidate.get() != equal && candidate.get() != going && !take(*candidate)) return;
      }
    }
  };
  std::size_t all_jobs = freed_jobs;
  std::uint64_t all_bytes = freed_bytes;
  each([&](const Computation& candidate) {
    all_jobs += candidate.jobs.size();
    all_bytes += candidate.bytes;
    return true;
  });
  if (!fits(jobs_, bytes, all_jobs, all_bytes)) return false;
  bool enough = false;
  each([&](Computation& candidate) {
    while (!candidate.jobs.empty()) withdraw(candidate.jobs.front(), ErrorCode::queue_full, work);
    enough = reserved();
    return !enough;
  });
  return enough;
}

/// A job with a place within the limits.
void Scheduler::admit(Arrival& arrival, const std::shared_ptr<Computation>& equal, DeferredWork& work) {
  const std::shared_ptr<JobRecord>& job = arrival.job;
  const std::shared_ptr<Computation> posted = job->computation;
  job->counted = true;
  if (closed_) {
    bytes_ -= posted->bytes;
    settle(*job);
    return refuse(arrival, ErrorCode::stopped, work);
  }
  if (equal) {
    bytes_ -= std::exchange(posted->bytes, 0);
    news_ = true;  // for posts that wait for room
    work.ended.splice(work.ended.end(), arrival.node);
    job->computation = equal;
    job->progress = &equal->progress;
    if (job->priority > equal->priority) rank(equal, job->priority);
  } else {
    enqueue(posted, arrival.node, false);
    if (!arrival.shareable.empty()) {
      posted->entry = shareable_.insert(arrival.shareable.extract(arrival.shareable.begin()));
      posted->indexed = true;
    }
    ++work.startable;
  }
  job->computation->jobs.splice(job->computation->jobs.end(), arrival.job_node);
  if (job->key.empty()) return;
  const auto newest = newest_.find(job->key);
  if (newest == newest_.end()) {
    newest_.insert(arrival.keyed.extract(arrival.keyed.begin()));
    return;
  }
  const std::shared_ptr<JobRecord> older = std::exchange(newest->second, job);
  // Last: if it is the older job's run that this one shares, that must not stop.
  if (older != job) withdraw(older, ErrorCode::replaced, work);
}

void Scheduler::refuse(Arrival& arrival, ErrorCode reason, DeferredWork& work) {
  arrival.job->withdrawn = reason;
  arrival.job->settled = true;
  work.losers.splice(work.losers.end(), arrival.job_node);
  work.ended.splice(work.ended.end(), arrival.node);
}

std::shared_ptr<Computation> Scheduler::find_equal(const Arrival& arrival) const {
  if (arrival.shareable.empty()) return nullptr;
  const auto [hash, computation] = *arrival.shareable.begin();
  const auto [first, last] = shareable_.equal_range(hash);
  for (auto place = first; place != last; ++place) {
    const std::shared_ptr<Computation>& candidate = place->second;
    if (candidate->kind != computation->kind) continue;
    // One that was told to stop gives no result.
    if (candidate->stopping) continue;
    if (candidate->list == &running_ && !computation->joinable_while_running) continue;
    try {
      if (candidate->equals(*computation)) return candidate;
    } catch (...) {  // NOLINT(bugprone-empty-catch): a comparison that fails finds nothing equal
    }
  }
  return nullptr;
}

void Scheduler::close(Computation& computation) {
  if (!computation.indexed) return;
  shareable_.erase(computation.entry);
  computation.indexed = false;
}

bool Scheduler::fits(std::size_t jobs, std::uint64_t bytes, std::size_t freed_jobs,
                     std::uint64_t freed_bytes) const noexcept {
  // What is there may be beyond the limits: posts from the worker's own threads are let in.
  const std::uint64_t rest = bytes_ - freed_bytes;
  return jobs - freed_jobs < options_.max_jobs && rest <= options_.max_bytes && bytes <= options_.max_bytes - rest;
}

bool Scheduler::reserve(std::uint64_t bytes, std::size_t freed_jobs, std::uint64_t freed_bytes) noexcept {
  std::size_t jobs = jobs_;
  do {
    if (!fits(jobs, bytes, freed_jobs, freed_bytes)) return false;
  } while (!jobs_.compare_exchange_weak(jobs, jobs + 1));
  std::uint64_t held = bytes_;
  do {
    const std::uint64_t rest = held - freed_bytes;
    if (rest > options_.max_bytes || bytes > options_.max_bytes - rest) {
      --jobs_;
      signal();  // whoever saw the place taken looks again
      return false;
    }
  } while (!bytes_.compare_exchange_weak(held, held + bytes));
  return true;
}

void Scheduler::settle(JobRecord& job) {
  job.settled = true;
  news_ = true;
  if (std::exchange(job.counted, false)) --jobs_;
  forget(job);
}

void Scheduler::forget(const JobRecord& job) {
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
