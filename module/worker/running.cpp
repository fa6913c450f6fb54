// Starting computations, running them, and what they leave.
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "platform/thread.h"
#include "worker/scheduler.h"
#include "worker/thread_executor.h"

namespace welkin::detail {
namespace {

/// Looks whether a job is ready for about as long as it takes the system to wake two sleeping threads, which is what
/// going to sleep at once would cost: the worker's, and then this one.
void look_briefly(const JobRecord& job) noexcept {
  constexpr std::chrono::microseconds kTime{150};
  const auto end = std::chrono::steady_clock::now() + kTime;
  while (!job.ready.load(std::memory_order_acquire) && std::chrono::steady_clock::now() < end) {
    std::this_thread::yield();
  }
}

}  // namespace

ComputationList& Scheduler::waiting(Priority priority) noexcept { return waiting_[static_cast<std::size_t>(priority)]; }

bool Scheduler::any_waiting() const noexcept {
  return !waiting_[0].empty() || !waiting_[1].empty() || !waiting_[2].empty();
}

bool Scheduler::is_waiting(const Computation& computation) const noexcept {
  return computation.list != nullptr && computation.list != &running_ && !computation.parent;
}

bool Scheduler::has_waiting() const {
  const Lock lock(mutex_);
  return any_waiting();
}

void Scheduler::enqueue(const std::shared_ptr<Computation>& computation, ComputationList& from, bool in_front) {
  ComputationList& list = waiting(computation->priority);
  list.splice(in_front ? list.begin() : list.end(), from);
  computation->list = &list;
  computation->place = in_front ? list.begin() : std::prev(list.end());
}

ComputationList Scheduler::taken_out(const std::shared_ptr<Computation>& computation) {
  ComputationList node;
  node.splice(node.begin(), *computation->list, computation->place);
  computation->list = nullptr;
  computation->parent = nullptr;
  close(*computation);
  bytes_ -= std::exchange(computation->bytes, 0);
  idle_.notify_all();
  return node;
}

void Scheduler::update_priority(const std::shared_ptr<Computation>& computation) {
  if (!is_waiting(*computation) && !computation->parent) return;
  Priority highest = Priority::low;
  for (const std::shared_ptr<JobRecord>& job : computation->jobs) highest = std::max(highest, job->priority);
  rank(computation, highest);
}

void Scheduler::rank(const std::shared_ptr<Computation>& computation, Priority priority) {
  if (priority == computation->priority) return;
  computation->priority = priority;
  if (!is_waiting(*computation)) return;
  ComputationList node;
  node.splice(node.begin(), *computation->list, computation->place);
  enqueue(computation, node, false);
}

Priority Scheduler::priority_of(const JobRecord& job) const {
  const Lock lock(mutex_);
  return job.priority;
}

void Scheduler::set_priority(JobRecord& job, Priority priority) {
  const Lock lock(mutex_);
  job.priority = priority;
  if (!job.settled) update_priority(job.computation);
}

void Scheduler::call_for_hands() {
  if (executor_->lent()) {
    // Whoever ends the worker waits for this: the arena may go after it.
    const Lock lock(mutex_);
    if (closed_) return;
    ++calling_;
  }
  const bool called = executor_->call_one(shared_from_this());
  const Lock lock(mutex_);
  if (executor_->lent()) {
    --calling_;
    idle_.notify_all();
  }
  // A thread that was called may yet be kept by a tile in which somebody waits; but then something runs.
  if (!watching_ && any_waiting() && (!called || executor_->lent() || !running_.empty())) watch_.notify_one();
}

void Scheduler::start_running(const std::shared_ptr<Computation>& computation) {
  running_.splice(running_.end(), *computation->list, computation->place);
  computation->list = &running_;
  computation->thread = current_thread_number();
  ++events_;
  // What it waits for may be among these, and the thread that was called for that kept by one of its tiles.
  if (!watching_ && any_waiting()) watch_.notify_one();
}

bool Scheduler::run_next() {
  std::shared_ptr<Computation> next;
  {
    const Lock lock(mutex_);
    for (auto list = waiting_.rbegin(); list != waiting_.rend() && !next; ++list) {
      if (!list->empty()) next = list->front();
    }
    if (!next) return false;
    start_running(next);
  }
  run(next);
  return true;
}

void Scheduler::help(const JobRecord& job) {
  if (!ThreadExecutor::runs_for(*this)) return look_briefly(job);
  // A continuation waits for what it follows, and that for what it follows: from the first on.
  std::vector<std::shared_ptr<Computation>> line;
  try {
    const Lock lock(mutex_);
    if (job.settled) return;
    line.push_back(job.computation);
    while (line.back()->parent) line.push_back(line.back()->parent->computation);
  } catch (const std::bad_alloc&) {
    return;  // then it waits, as on a plain future
  }
  for (auto next = line.rbegin(); next != line.rend(); ++next) {
    {
      const Lock lock(mutex_);
      if (!is_waiting(**next)) return;
      start_running(*next);
    }
    run(*next);
  }
}

void Scheduler::run(const std::shared_ptr<Computation>& computation) {
  const Control control{computation->stop.get_token(),
                        [running = computation.get()](double done) { running->report(done); }};
  std::exception_ptr error;
  try {
    // Isolated: when it waits for tasks of its own, it does not pick up another job's, which may be long, or wait for
    // this very job.
    tbb::this_task_arena::isolate([&] { computation->run(control); });
  } catch (...) {
    error = std::current_exception();
  }
  complete(computation, std::move(error));
}

void Scheduler::complete(const std::shared_ptr<Computation>& computation, std::exception_ptr error) {
  JobList jobs;
  Orphans orphans;
  std::size_t wanted = 0;
  {
    const Lock lock(mutex_);
    ++events_;
    close(*computation);
    jobs.splice(jobs.end(), computation->jobs);
    bytes_ -= std::exchange(computation->bytes, 0);
    for (const std::shared_ptr<JobRecord>& job : jobs) {
      settle(*job);
      if (!job->withdrawn) ++wanted;
    }
  }
  const bool failed = error != nullptr;
  if (!failed) computation->report(1.0);
  for (const std::shared_ptr<JobRecord>& job : jobs) {
    if (job->withdrawn) {
      fail(*job, *job->withdrawn, orphans);
      continue;
    }
    --wanted;
    try {
      if (failed) {
        job->fail(wanted > 0 ? error : std::exchange(error, nullptr));
      } else {
        computation->deliver(*job, wanted == 0);
      }
    } catch (...) {
      job->fail(std::current_exception());
    }
    job->ready.store(true, std::memory_order_release);
    pass_on(*job, orphans);
  }
  computation->release();
  abandon(std::move(orphans));
  const Lock lock(mutex_);
  static_cast<void>(taken_out(computation));
}

void Scheduler::wait_until_idle() {
  if (ThreadExecutor::serves(*this)) return;
  Lock lock(mutex_);
  idle_.wait(lock, [&] { return !any_waiting() && running_.empty(); });
}

}  // namespace welkin::detail
