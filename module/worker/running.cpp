// Starting computations, running them, what they leave, and waiting for them.
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <new>
#include <thread>
#include <utility>

#include "jobs/activity.h"
#include "platform/spin.h"
#include "platform/wait.h"
#include "worker/scheduler.h"
#include "worker/thread_executor.h"

namespace welkin::detail {
namespace {

thread_local const ThreadRole* innermost_role = nullptr;

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

/// What an executor is given to call.
struct LentTask : InJobMemory {
  explicit LentTask(std::shared_ptr<Scheduler> its_scheduler) noexcept : scheduler(std::move(its_scheduler)) {}
  std::shared_ptr<Scheduler> scheduler;
};

}  // namespace

ThreadRole::ThreadRole(Scheduler& scheduler, Kind kind) noexcept
    : scheduler_(&scheduler), kind_(kind), outer_(innermost_role) {
  innermost_role = this;
}
ThreadRole::~ThreadRole() { innermost_role = outer_; }

template <class Wanted>
const ThreadRole* ThreadRole::innermost(const Wanted& wanted) noexcept {
  const ThreadRole* role = innermost_role;
  while (role != nullptr && !wanted(*role)) role = role->outer_;
  return role;
}

bool ThreadRole::has_any(const Scheduler& scheduler) noexcept {
  return innermost([&](const ThreadRole& role) { return role.scheduler_ == &scheduler; }) != nullptr;
}

bool ThreadRole::is_worker(const Scheduler& scheduler) noexcept {
  return innermost([&](const ThreadRole& role) { return role.scheduler_ == &scheduler && role.kind_ == worker; }) !=
         nullptr;
}

Scheduler* ThreadRole::scheduler() noexcept {
  const ThreadRole* const role = innermost([](const ThreadRole&) { return true; });
  return role != nullptr && role->kind_ == worker ? role->scheduler_ : nullptr;
}

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

ComputationList& Scheduler::waiting(TaskPriority priority) noexcept {
  return waiting_[static_cast<std::size_t>(priority)];
}

std::size_t Scheduler::waiting_count() const noexcept {
  return waiting_[0].size() + waiting_[1].size() + waiting_[2].size();
}

bool Scheduler::is_waiting(const Computation& computation) const noexcept {
  return computation.list != nullptr && computation.list != &running_ && !computation.parent;
}

bool Scheduler::has_waiting() {
  const Books books(*this);
  return waiting_count() > 0;
}

void Scheduler::enqueue(const std::shared_ptr<Computation>& computation, ComputationList& from, bool in_front) {
  ComputationList& list = waiting(computation->priority);
  list.splice(in_front ? list.begin() : list.end(), from);
  news_ = true;
  if (computation->waiting_since == Clock::time_point{}) computation->waiting_since = Clock::now();
  computation->list = &list;
  computation->place = in_front ? list.begin() : std::prev(list.end());
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
  const Books books(*this);
  return job.computation->priority;
}

void Scheduler::set_priority(const JobRecord& job, TaskPriority priority) {
  const Books books(*this);
  const std::shared_ptr<Computation>& computation = job.computation;
  if (std::exchange(computation->priority, priority) == priority || !is_waiting(*computation)) return;
  ComputationList node;
  node.splice(node.begin(), *computation->list, computation->place);
  enqueue(computation, node, false);
}

// Threads.

/// With the mutex held: whom to call for what waits.
void Scheduler::plan_calls(DeferredWork& work) {
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
    ++lending_;  // until this is over, whoever ends the worker waits: the executor may go then
  }
}

/// Without the mutex, and without any other lock: `post` comes through here.
void Scheduler::call_for_hands(DeferredWork& work) {
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
    Books books(*this);
    books.work.refused = true;
    lent_ -= tasks;
    unstarted_ -= tasks;
    // A task that is there yet will ask again when it ends. If there is none, nobody will.
    for (ComputationList& list : waiting_) {
      while (lent_ == 0 && !list.empty()) {
        end(std::shared_ptr<Computation>(list.front()), std::current_exception(), books.work);
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
  const Books books(scheduler);
  --scheduler.lent_;
}

bool Scheduler::run_next(bool lent, TaskPriority least) {
  const jobs::ActivityScope computing;
  std::shared_ptr<Computation> next;
  {
    const Books books(*this);
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
    const Books books(*this);
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
    signal();  // who waits for a result does not wait for the books
    Books books(*this);
    hand_on(*job, books.work);
  }
  computation->release();
  // Both go when the books are closed.
  ComputationList over;
  stop_source stop(nostopstate);
  const Books books(*this);
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
        const Books books(*this);
        next = startable_for(job);
        if (next) start_running(next);
      }
      if (!next) return false;
      run(next);
    }
    return true;
  });
}

/// What must run first for the job, if no thread has started it.
std::shared_ptr<Computation> Scheduler::startable_for(const JobRecord& job) const {
  const std::shared_ptr<Computation>* first = &job.computation;
  while ((*first)->parent) first = &(*first)->parent->computation;
  return is_waiting(**first) ? *first : nullptr;
}

void Scheduler::wait_until_idle() {
  if (ThreadRole::has_any(*this)) return;
  wait_for([&] {
    const Books books(*this);
    return waiting_count() == 0 && running_.empty();
  });
}

}  // namespace welkin::detail
