// The scheduler: letting jobs in, giving them up, what follows them, running them, waiting for them, the end.
#include "worker/scheduler.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <iterator>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <utility>

#include "jobs/activity.h"
#include "platform/file.h"
#include "platform/text.h"
#include "platform/thread.h"
#include "platform/wait.h"
#include "welkin/worker.h"
#include "worker/thread_executor.h"

namespace welkin::detail {
namespace {

constexpr int kMaxThreads = 1024;

void check(const WorkerOptions& options) {
  const int threads = options.executor ? options.executor->concurrency() : options.threads;
  const int minimum = options.executor ? 1 : 0;
  const char* what = options.executor ? "WorkerOptions: the executor's concurrency" : "WorkerOptions: threads";
  platform::require_between(what, threads, minimum, kMaxThreads);
  if (options.max_jobs == 0) {
    throw Error(ErrorCode::invalid_argument, "WorkerOptions: max_jobs is 0; it must be at least 1");
  }
}

// A fork has a copy of it, as it was when it was made.
std::atomic<std::int64_t> sound_process{platform::process_number()};

/// Throws `Error` (stopped) in a fork that may have locks which no thread will open: a thread of the parent may have
/// been anywhere, in our caches, in oneTBB's heap in the middle of an allocation, or asleep on a stack that a thread of
/// this process has now.
void require_no_lost_locks() {
  if (sound_process == platform::process_number()) return;
  if (jobs::activities != 0) {
    throw Error(ErrorCode::stopped,
                "this process was forked while its parent had a worker or a call of it computed, whose locks are "
                "never released here; fork before workers are created or after they are destroyed, or run another "
                "program (exec)");
  }
  sound_process = platform::process_number();
}

/// Looks whether a job is ready for about as long as it takes the system to wake two sleeping threads, which is what
/// going to sleep at once would cost: the worker's, and then this one. `keeping`: it keeps its processor at first, for
/// as long as a small job takes on a thread that is awake. Where the worker's threads take all processors, one of them
/// waits for this one.
void look_briefly(const JobRecord& job, bool keeping) noexcept {
  constexpr std::chrono::microseconds kKeeping{20};
  constexpr std::chrono::microseconds kTime{150};
  const auto ready = [&] { return job.ready.load(std::memory_order_acquire); };
  if (keeping && spin_until(ready, kKeeping)) return;
  const auto end = Scheduler::Clock::now() + kTime;
  while (!ready() && Scheduler::Clock::now() < end) std::this_thread::yield();
}

/// Made by the thread that runs a computation, which also gives the memory back; empty if there is none.
stop_source make_stop_source() noexcept {
  try {
    return {};
  } catch (const std::bad_alloc&) {
    return stop_source(nostopstate);
  }
}

/// The task that an executor is given to call.
struct LentTask : InJobMemory {
  explicit LentTask(std::shared_ptr<Scheduler> its_scheduler) noexcept : scheduler(std::move(its_scheduler)) {}
  std::shared_ptr<Scheduler> scheduler;
};

}  // namespace

void let_another_pass(TaskPriority priority) {
  constexpr int kDeepest = 8;  // each is so much stack
  thread_local int depth = 0;
  Scheduler* const scheduler = ThreadRole::scheduler();
  if (scheduler == nullptr || depth == kDeepest) return;
  struct Deeper {
    Deeper() { ++depth; }
    ~Deeper() { --depth; }
  } const deeper;
  scheduler->run_next(false, priority);
}

Submission::Submission(std::shared_ptr<Computation> computation, std::shared_ptr<JobRecord> its_job,
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
  for (Submission* submission = inbox_; submission != nullptr;) delete std::exchange(submission, submission->next);
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

Scheduler::LockedState::LockedState(Scheduler& scheduler, Lock lock) : scheduler_(scheduler), lock_(std::move(lock)) {
  if (lock_) scheduler_.empty_inbox(work);
}

Scheduler::LockedState::~LockedState() {
  while (lock_) {
    scheduler_.tell_jobs_of(work);
    scheduler_.plan_calls(work);
    work.news = std::exchange(scheduler_.news_, false);
    lock_.unlock();
    scheduler_.carry_out(work);
    // Submissions that came while the mutex was held, from this thread or from another one that `carry_out` has met.
    if (!scheduler_.inbox_has_something() || !lock_.try_lock()) return;
    scheduler_.empty_inbox(work);
  }
}

void Scheduler::put_in_inbox(std::unique_ptr<Submission> submission) {
  submission->next = inbox_.load(std::memory_order_relaxed);
  while (!inbox_.compare_exchange_weak(submission->next, submission.get(), std::memory_order_acq_rel)) {
  }
  static_cast<void>(submission.release());
  const LockedState state(*this, Lock(mutex_, std::try_to_lock));
}

/// Called after the mutex was unlocked. An exchange and not a load, so that it is ordered among the inbox's
/// changes: a submission comes before it, and is seen, or after it, and then its thread sees the mutex unlocked.
bool Scheduler::inbox_has_something() noexcept {
  Submission* none = nullptr;
  return !inbox_.compare_exchange_strong(none, nullptr, std::memory_order_acq_rel);
}

void Scheduler::empty_inbox(AfterUnlock& work) {
  Submission* newest = inbox_.exchange(nullptr, std::memory_order_acq_rel);
  Submission* oldest = nullptr;
  while (newest != nullptr) {
    Submission* const next = std::exchange(newest->next, oldest);
    oldest = std::exchange(newest, next);
  }
  while (oldest != nullptr) {
    const std::unique_ptr<Submission> submission(std::exchange(oldest, oldest->next));
    if (submission->parent) {
      follow(*submission, work);
    } else {
      admit(*submission, work);
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

  // All that may run out of memory comes before the state change.
  auto submission = std::make_unique<Submission>(posted, job, nullptr);
  if (!follower.empty()) attach(follower, job);
  if (!closed_ && reserve(posted->bytes)) return put_in_inbox(std::move(submission));
  LockedState state(*this);
  if (const std::optional<ErrorCode> reason = reason_to_refuse(*submission)) {
    job->withdrawn = reason;
    job->settled = true;
    posted->record = job;
    state.work.ended.splice(state.work.ended.end(), submission->node);
  } else {
    admit(*submission, state.work);
  }
}

/// Returns why a job that may be beyond the limits is refused. Without a reason, its slot within them is reserved.
std::optional<ErrorCode> Scheduler::reason_to_refuse(const Submission& submission) {
  if (closed_) return ErrorCode::stopped;
  const std::uint64_t bytes = submission.job->computation->bytes;
  if (bytes > options_.max_bytes) return ErrorCode::limit_exceeded;
  // Withdrawing a waiting job of the same key frees its slot at once.
  const auto newest = newest_.find(submission.job->key);
  const bool frees = newest != newest_.end() && is_waiting(*newest->second->computation);
  const bool fits = reserve(bytes, frees ? 1 : 0, frees ? newest->second->computation->bytes : 0);
  return fits ? std::nullopt : std::optional(ErrorCode::queue_full);
}

/// Admits a job that has a slot within the limits.
void Scheduler::admit(Submission& submission, AfterUnlock& work) {
  const std::shared_ptr<JobRecord>& job = submission.job;
  const std::shared_ptr<Computation>& posted = job->computation;
  job->counted = true;
  posted->record = job;
  let_wait(posted, submission.node, false, work);
  if (job->key.empty() || job->settled) return;
  const auto newest = newest_.find(job->key);
  if (newest == newest_.end()) {
    newest_.insert(submission.keyed.extract(submission.keyed.begin()));
  } else {
    withdraw(std::exchange(newest->second, job), ErrorCode::replaced, work);
  }
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

// Cancelling jobs, and what follows when they are done.

bool Scheduler::withdraw(std::shared_ptr<JobRecord> job, ErrorCode reason, AfterUnlock& work) {
  if (job->settled || job->withdrawn) return false;
  // A continuation that has not started cancels the job that it follows, whose result nothing else receives.
  while (job && !job->settled && !job->withdrawn) {
    job->withdrawn = reason;
    const std::shared_ptr<Computation> computation = job->computation;
    std::shared_ptr<JobRecord> next;
    if (computation->list == &running_) {
      stop(computation, work);
    } else {
      next = computation->parent;
      end(computation, nullptr, work);
    }
    job = next;
  }
  return true;
}

void Scheduler::stop(const std::shared_ptr<Computation>& computation, AfterUnlock& work) {
  computation->stopping = true;
  computation->next_to_stop = std::move(work.stopping);
  work.stopping = computation;
}

/// The job is ready: what follows it may start.
void Scheduler::dispatch_followers(JobRecord& job, AfterUnlock& work) {
  job.done = true;
  news_ = true;
  while (!job.followers.empty()) {
    const std::shared_ptr<Computation> next = job.followers.front();
    ComputationList node;
    node.splice(node.begin(), job.followers, job.followers.begin());
    next->parent = nullptr;
    next->list = nullptr;
    next->failure = error_of(job);
    if (next->where == CallSite::at_once) {
      work.at_once.splice(work.at_once.end(), node);
    } else if (next->where == CallSite::drain) {
      ComputationList& list = abandoned_ ? work.ended : drained_;
      list.splice(list.end(), node);
      undrained_.store(drained_.size(), std::memory_order_release);
    } else {
      let_wait(next, node, true, work);
    }
  }
}

/// Ends a waiting computation that no thread will start: because of the error, because it was withdrawn, or as the
/// worker has ended.
void Scheduler::end(const std::shared_ptr<Computation>& computation, std::exception_ptr error, AfterUnlock& work) {
  if (JobRecord* const job = computation->record.get()) {
    job->error = error;
    if (!error && !job->withdrawn) job->withdrawn = ErrorCode::stopped;
    settle(*job);
  }
  work.ended.splice(work.ended.end(), take_out(computation));
}

/// Makes the jobs of computations that will not start ready. `dispatch_followers` adds to the list: a chain of
/// followers may be long, and none ends inside the end of the one that it follows.
void Scheduler::tell_jobs_of(AfterUnlock& work) {
  for (const std::shared_ptr<Computation>& computation : work.ended) {
    if (!computation->record) continue;
    computation->record->ready.store(true, std::memory_order_release);
    dispatch_followers(*computation->record, work);
  }
}

/// Called without the mutex. All jobs have their errors before any coroutine goes on, as it may wait for one of them.
void Scheduler::carry_out(AfterUnlock& work) {
  // User code may throw out of a coroutine, a destructor or a stop callback, and no caller could catch it, as on a
  // thread of the worker.
  const auto go_on = [](const auto& call) {
    try {
      call();
    } catch (...) {  // NOLINT(bugprone-empty-catch)
    }
  };
  if (work.news) signal();
  wake_workers(work);
  while (work.stopping) {
    // The request's callbacks on its stop token run here, and could not wait for the request's end.
    const ThreadRole role(*this, ThreadRole::bystander);
    const std::shared_ptr<Computation> computation = std::move(work.stopping);
    work.stopping = std::move(computation->next_to_stop);
    computation->stop.request_stop();
  }
  for (const std::shared_ptr<Computation>& computation : work.at_once) {
    try {
      computation->run({});
    } catch (...) {
      computation->failure = std::current_exception();
      go_on([&] { computation->run({}); });
    }
  }
  for (const std::shared_ptr<Computation>& computation : work.ended) computation->release();
  for (const std::shared_ptr<Computation>& computation : work.ended) go_on([&] { computation->abandon(); });
  for (const std::shared_ptr<Computation>& computation : work.ended) computation->record = nullptr;
  work = {};
}

bool Scheduler::cancel(const std::shared_ptr<JobRecord>& job) {
  if (is_forked()) return false;  // destructors call this
  LockedState state(*this);
  return withdraw(job, ErrorCode::cancelled, state.work);
}

bool Scheduler::attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
                       const std::shared_ptr<JobRecord>& job) {
  require_own_process();
  if (job) {
    job->scheduler = parent->scheduler;
    job->id = next_id();
  }
  auto submission = std::make_unique<Submission>(child, job, parent);
  if (!closed_) {
    put_in_inbox(std::move(submission));
    return true;
  }
  LockedState state(*this);
  const bool too_late =
      parent->done && (child->where == CallSite::drain ? abandoned_ : child->where == CallSite::worker);
  if (too_late && !job) return false;
  follow(*submission, state.work);
  return !too_late;
}

void Scheduler::follow(Submission& submission, AfterUnlock& work) {
  const std::shared_ptr<Computation> child = submission.node.front();
  child->priority = submission.parent->computation->priority;
  child->record = submission.job;
  attach(submission.node, submission.parent);
  if (submission.parent->done) dispatch_followers(*submission.parent, work);
}

void Scheduler::attach(ComputationList& node, const std::shared_ptr<JobRecord>& parent) {
  Computation& child = *node.front();
  child.parent = parent;
  child.list = &parent->followers;
  child.place = node.begin();
  parent->followers.splice(parent->followers.end(), node);
}

// Starting computations, and what they leave.

std::size_t Scheduler::waiting_count() const noexcept {
  return waiting_[0].size() + waiting_[1].size() + waiting_[2].size();
}

bool Scheduler::is_waiting(const Computation& computation) const noexcept {
  return computation.list != nullptr && computation.list != &running_ && !computation.parent;
}

void Scheduler::enqueue(const std::shared_ptr<Computation>& computation, ComputationList& from, bool in_front) {
  ComputationList& list = waiting_[static_cast<std::size_t>(computation->priority)];
  list.splice(in_front ? list.begin() : list.end(), from);
  news_ = true;
  if (computation->waiting_since == Clock::time_point{}) computation->waiting_since = Clock::now();
  computation->list = &list;
  computation->place = in_front ? list.begin() : std::prev(list.end());
}

/// Lets a computation wait for a thread, unless none will come.
void Scheduler::let_wait(const std::shared_ptr<Computation>& computation, ComputationList& from, bool in_front,
                         AfterUnlock& work) {
  enqueue(computation, from, in_front);
  if (closed_) return end(computation, nullptr, work);
  ++work.startable;
}

ComputationList Scheduler::take_out(const std::shared_ptr<Computation>& computation) {
  ComputationList node;
  node.splice(node.begin(), *computation->list, computation->place);
  news_ = true;
  computation->list = nullptr;
  computation->parent = nullptr;
  bytes_ -= std::exchange(computation->bytes, 0);
  return node;
}

TaskPriority Scheduler::priority_of(const JobRecord& job) {
  const LockedState state(*this);
  return job.computation->priority;
}

void Scheduler::set_priority(const JobRecord& job, TaskPriority priority) {
  const LockedState state(*this);
  const std::shared_ptr<Computation>& computation = job.computation;
  if (std::exchange(computation->priority, priority) == priority || !is_waiting(*computation)) return;
  ComputationList node;
  node.splice(node.begin(), *computation->list, computation->place);
  enqueue(computation, node, false);
}

// Threads.

/// Plans, with the mutex held, which threads to call for computations that wait.
void Scheduler::plan_calls(AfterUnlock& work) {
  if (own_threads_) {
    // While something runs, threads that are parked may be inside of its tasks, and it does not show which: all are
    // called. (What this thread itself runs has no tasks now.)
    const std::size_t mine = ThreadRole::is_worker(*this) ? 1 : 0;
    if (work.startable > 0 && running_.size() > mine) work.startable = threads_;
  } else if (options_.executor && !closed_ && !work.refused) {
    work.tasks = std::min(threads_ - lent_, static_cast<int>(waiting_count()) - unstarted_);
    if (work.tasks <= 0) return;
    lent_ += work.tasks;
    unstarted_ += work.tasks;
    ++lending_;  // until this is over, the thread that ends the worker waits: the executor may go then
  }
}

/// Called without the mutex, and without any other lock: `post` comes through here.
void Scheduler::wake_workers(AfterUnlock& work) {
  if (own_threads_) {
    own_threads_->call(std::exchange(work.startable, 0));
    return;
  }
  int tasks = std::exchange(work.tasks, 0);
  if (tasks <= 0) return;
  try {
    for (; tasks > 0; --tasks) {
      auto task = std::make_unique<LentTask>(shared_from_this());
      options_.executor->enqueue(run_task, task.get());
      static_cast<void>(task.release());
    }
  } catch (...) {
    LockedState state(*this);
    state.work.refused = true;
    lent_ -= tasks;
    unstarted_ -= tasks;
    // A task that is still there requests more when it ends. If there is none, nothing will.
    for (ComputationList& list : waiting_) {
      while (lent_ == 0 && !list.empty()) {
        end(std::shared_ptr<Computation>(list.front()), std::current_exception(), state.work);
      }
    }
  }
  --lending_;
  signal();
}

void Scheduler::run_task(void* task) {
  const std::unique_ptr<LentTask> lent(static_cast<LentTask*>(task));
  Scheduler& scheduler = *lent->scheduler;
  if (scheduler.is_forked()) return;  // an executor that lives on in a fork of the process
  {
    const ThreadRole role(scheduler);
    scheduler.run_next(true);
  }
  const LockedState state(scheduler);
  --scheduler.lent_;
}

bool Scheduler::run_next(bool lent, TaskPriority least) {
  const jobs::ActivityScope computing;
  std::shared_ptr<Computation> next;
  {
    const LockedState state(*this);
    if (lent) --unstarted_;
    const auto end = std::prev(waiting_.rend(), static_cast<std::ptrdiff_t>(least));
    for (auto list = waiting_.rbegin(); list != end && !next; ++list) {
      if (!list->empty()) next = list->front();
    }
    if (!next) return false;
    start_running(next);
  }
  run(next);
  return true;
}

void Scheduler::start_running(const std::shared_ptr<Computation>& computation) {
  computation->stop = make_stop_source();
  running_.splice(running_.end(), *computation->list, computation->place);
  computation->list = &running_;
}

void Scheduler::run(const std::shared_ptr<Computation>& computation) {
  const Control control{computation->stop.get_token(),
                        [running = computation.get()](double done) { running->report(done); }};
  std::exception_ptr error;
  const bool must_run = computation->runs_after_errors;
  if (computation->failure && !must_run) {
    error = computation->failure;
  } else if (!computation->stop.stop_possible() && !must_run) {
    error = std::make_exception_ptr(std::bad_alloc());
  } else {
    const ThreadRole role(*this);
    try {
      // Isolated: when it waits for tasks of its own, it does not pick up another job's, which may be long, or wait for
      // this very job.
      tbb::this_task_arena::isolate([&] { computation->run(control); });
    } catch (...) {
      error = std::current_exception();
    }
  }
  complete(computation, std::move(error));
}

void Scheduler::complete(const std::shared_ptr<Computation>& computation, std::exception_ptr error) {
  const std::shared_ptr<JobRecord> job = computation->record;
  bool wanted = false;
  {
    const LockedState state(*this);
    bytes_ -= std::exchange(computation->bytes, 0);
    if (job) settle(*job);
    wanted = job && !job->withdrawn;
  }
  if (!error) computation->report(1.0);
  if (wanted) {
    try {
      if (!error) computation->deliver(*job);
      job->error = error;
    } catch (...) {
      job->error = std::current_exception();
    }
  }
  error = nullptr;
  if (job) {
    job->ready.store(true, std::memory_order_release);
    signal();  // who waits for a result does not wait for the state
    LockedState state(*this);
    dispatch_followers(*job, state.work);
  }
  computation->release();
  // Both go when the lock is released.
  ComputationList over;
  stop_source stop(nostopstate);
  const LockedState state(*this);
  over = take_out(computation);
  computation->record = nullptr;
  if (!computation->stopping) std::swap(stop, computation->stop);
}

// Waiting.

void Scheduler::signal() {
  ++signals_;
  platform::wake_all(signals_);
}

void Scheduler::wait(const JobRecord& job) {
  const auto ready = [&] { return job.ready.load(std::memory_order_acquire); };
  if (ready()) return;
  require_own_process();
  if (!ThreadRole::is_worker(*this)) {
    look_briefly(job, callers_may_look_);
    return wait_for(ready);
  }
  // Nothing must be left to another thread, because all may wait: what the job needs first is run here, and if another
  // thread runs that, what comes next when it is done.
  wait_for([&] {
    while (!ready()) {
      std::shared_ptr<Computation> next;
      {
        const LockedState state(*this);
        next = startable_for(job);
        if (next) start_running(next);
      }
      if (!next) return false;
      run(next);
    }
    return true;
  });
}

/// Returns the computation that must run first for the job; null if a thread has started it.
std::shared_ptr<Computation> Scheduler::startable_for(const JobRecord& job) const {
  const std::shared_ptr<Computation>* first = &job.computation;
  while ((*first)->parent) first = &(*first)->parent->computation;
  return is_waiting(**first) ? *first : nullptr;
}

void Scheduler::wait_until_idle() {
  if (ThreadRole::has_any(*this)) return;
  wait_for([&] {
    const LockedState state(*this);
    return waiting_count() == 0 && running_.empty();
  });
}

WorkerLoad Scheduler::load() {
  const LockedState state(*this);
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

// Callbacks, and the end.

std::size_t Scheduler::drain(std::chrono::nanoseconds budget) {
  constexpr std::chrono::microseconds kPause{20};
  constexpr std::chrono::nanoseconds kMin = std::chrono::microseconds(100);
  require_own_process();
  const auto start = Clock::now();
  const auto spent = [&](std::chrono::nanoseconds allowed) { return Clock::now() - start >= allowed; };
  std::size_t there = 0;
  for (std::size_t called = 0;; ++called) {
    // Without the mutex: most frames have nothing to drain.
    const bool nothing = undrained_.load(std::memory_order_acquire) == 0 && inbox_.load() == nullptr;
    if (nothing || (called > 0 && (called >= there || spent(budget)))) return called;
    ComputationList one;
    {
      // The mutex may be held by a thread of ours that more important ones keep off the processor: the budget is for
      // that too. Sleeping, and not spinning, gives it this one. A thread that merely looks for work lets go of the
      // mutex in less than `kMin`, and then the first callback runs whatever the budget is.
      Lock lock(mutex_, std::try_to_lock);
      while (!lock) {
        if (spent(called == 0 ? std::max(budget, kMin) : budget)) return called;
        std::this_thread::sleep_for(kPause);
        static_cast<void>(lock.try_lock());
      }
      const LockedState state(*this, std::move(lock));
      if (called == 0) there = drained_.size();
      if (drained_.empty()) return called;
      one.splice(one.begin(), drained_, drained_.begin());
      undrained_.store(drained_.size(), std::memory_order_release);
    }
    one.front()->run({});
  }
}

void Scheduler::terminate() {
  if (is_forked()) {
    kept_ = shared_from_this();
    return;
  }
  {
    LockedState state(*this);
    closed_ = true;
    for (ComputationList& list : waiting_) {
      while (!list.empty()) end(std::shared_ptr<Computation>(list.front()), nullptr, state.work);
    }
    for (const std::shared_ptr<Computation>& computation : running_) {
      JobRecord* const job = computation->record.get();
      if (job == nullptr || job->settled || computation->stopping) continue;
      job->withdrawn = ErrorCode::stopped;
      stop(computation, state.work);
    }
  }
  if (own_threads_) own_threads_->dismiss();
  if (ThreadRole::has_any(*this)) return;
  wait_for([&] {
    const LockedState state(*this);
    return running_.empty() && lending_ == 0;
  });
  if (own_threads_) own_threads_->join();
  std::shared_ptr<Executor> no_more_used;
  const LockedState state(*this);
  no_more_used.swap(options_.executor);
}

void Scheduler::abandon_rest() {
  if (is_forked()) return;
  {
    LockedState state(*this);
    abandoned_ = true;
    state.work.ended.splice(state.work.ended.end(), drained_);
    undrained_.store(0, std::memory_order_release);
  }
  if (own_threads_ && ThreadRole::has_any(*this)) own_threads_->detach();
}

}  // namespace welkin::detail
