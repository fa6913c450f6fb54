// The threads of a worker, in an arena that no other thread enters.
#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "platform/float_environment.h"
#include "welkin/worker.h"

namespace welkin::detail {

/// Returns whether `threads` busy threads leave a processor for another. If not, a thread that waits yields its own.
[[nodiscard]] inline bool leaves_a_processor(int threads) {
  const platform::FloatingPointScope floating_point;  // counting processors divides
  return threads < available_threads();
}

/// The threads take all slots of an arena as external threads, so that oneTBB sends none of the process's pool there,
/// and the pool stays the engine's. A thread that finds nothing to start parks: it waits in the arena for a task group
/// that a thread with work for it ends. oneTBB has it take part in the parallel work of the others meanwhile, and puts
/// it to sleep if there is none.
///
/// A thread that has just ended a job, when no other runs, first looks for the next one for some microseconds: jobs
/// that are posted one after the other find it awake.
class ThreadExecutor {
 public:
  explicit ThreadExecutor(const WorkerOptions& options);
  ~ThreadExecutor() = default;
  ThreadExecutor(const ThreadExecutor&) = delete;
  ThreadExecutor& operator=(const ThreadExecutor&) = delete;

  [[nodiscard]] int concurrency() const noexcept { return threads_; }

  /// Starts the threads. They keep `scheduler`. Throws std::system_error: then some may run.
  void start(const std::shared_ptr<Scheduler>& scheduler);
  /// Has `count` parked threads look for work, or all if these are fewer. Takes no lock, as a thread of ours may hold
  /// it and be kept off the processors.
  void call(int count);
  /// Threads leave as soon as they have nothing more to do.
  void dismiss();
  /// Waits until they have left. Not on one of them.
  void join();
  /// Lets go of them.
  void detach();

 private:
  /// Where a thread waits for work.
  struct Parking {
    tbb::task_group group;
    tbb::task_handle blocker;  ///< the group's wait ends when this goes
  };
  /// Points to a blocker, or to `looking_`.
  using Sleeper = std::atomic<tbb::task_handle*>;

  void serve(Scheduler& scheduler, int number);
  /// Looks for a while, if nothing runs. Returns whether there may be something to start.
  bool look_for_work(Scheduler& scheduler, Sleeper& sleeper);
  void park(Scheduler& scheduler, Sleeper& sleeper);
  /// Ends a thread's wait by extracting the blocker from its sleeper. Returns whether there was one.
  bool call(Sleeper& sleeper);
  /// Calls the threads that only look. Returns how many there were.
  int call_looking();
  void set_up_thread(int number) const noexcept;

  int threads_;
  ThreadPriority priority_;
  std::string name_;
  tbb::task_arena arena_;
  bool looks_;                     ///< whether a thread that looks takes no processor from one that posts
  tbb::task_handle looking_;       ///< blocks nothing: in the sleeper of a thread that only looks
  std::vector<Sleeper> sleepers_;  ///< one per thread; null while the thread does not wait
  std::atomic<bool> dismissed_{false};

  std::mutex threads_mutex_;  ///< only one may join, and all wait for that
  std::vector<std::thread> own_threads_;
};

/// The calling thread's role for a scheduler, for as long as this object lives.
class ThreadRole {
 public:
  enum Kind {
    worker,     ///< its own, or a lent one that runs its work
    bystander,  ///< inside something that its work waits for
  };
  explicit ThreadRole(Scheduler& scheduler, Kind kind = worker) noexcept
      : scheduler_(&scheduler), kind_(kind), outer_(innermost_) {
    innermost_ = this;
  }
  ~ThreadRole() { innermost_ = outer_; }
  ThreadRole(const ThreadRole&) = delete;
  ThreadRole& operator=(const ThreadRole&) = delete;

  /// Returns whether the thread is either kind, and so must not wait for the scheduler's work to end.
  [[nodiscard]] static bool has_any(const Scheduler& scheduler) noexcept {
    return is_worker(scheduler) || has(scheduler, bystander);
  }
  /// Returns whether the scheduler may run computations on it.
  [[nodiscard]] static bool is_worker(const Scheduler& scheduler) noexcept { return has(scheduler, worker); }
  /// The scheduler that may run computations on the thread, the innermost one; null if there is none.
  [[nodiscard]] static Scheduler* scheduler() noexcept {
    return innermost_ != nullptr && innermost_->kind_ == worker ? innermost_->scheduler_ : nullptr;
  }

 private:
  [[nodiscard]] static bool has(const Scheduler& scheduler, Kind kind) noexcept {
    const ThreadRole* role = innermost_;
    while (role != nullptr && (role->scheduler_ != &scheduler || role->kind_ != kind)) role = role->outer_;
    return role != nullptr;
  }

  inline static thread_local const ThreadRole* innermost_ = nullptr;

  Scheduler* scheduler_;
  Kind kind_;
  const ThreadRole* outer_;
};

}  // namespace welkin::detail
