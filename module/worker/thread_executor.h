// The threads that a worker has of its own, in an arena that nobody else enters.
#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "welkin/worker.h"

namespace welkin::detail {

/// The threads take all slots of an arena as external threads, so that oneTBB sends none of the process's pool there,
/// and the pool stays the engine's. A thread that finds nothing to start parks: it waits in the arena for a task group
/// that whoever has work for it ends. oneTBB has it take part in the parallel work of the others meanwhile, and puts it
/// to sleep if there is none.
class ThreadExecutor {
 public:
  explicit ThreadExecutor(const WorkerOptions& options);
  ~ThreadExecutor() = default;
  ThreadExecutor(const ThreadExecutor&) = delete;
  ThreadExecutor& operator=(const ThreadExecutor&) = delete;

  [[nodiscard]] int concurrency() const noexcept { return threads_; }

  /// Starts the threads. They keep `scheduler`. Throws std::system_error: then some may run.
  void start(const std::shared_ptr<Scheduler>& scheduler);
  /// Has so many parked threads look for work, or all if these are fewer. Takes no lock, as a thread of ours may hold
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
  using Place = std::atomic<Parking*>;

  void serve(Scheduler& scheduler, int number);
  void park(Scheduler& scheduler, Place& place);
  /// Whoever takes a parking out of its place ends its wait. True if there was one.
  static bool call(Place& place);
  void set_up_thread(int number) const noexcept;

  int threads_;
  ThreadPriority priority_;
  std::string name_;
  tbb::task_arena arena_;
  std::vector<Place> places_;  ///< one a thread; null while the thread does not wait
  std::atomic<bool> dismissed_{false};

  std::mutex threads_mutex_;  ///< only one may join, and all wait for that
  std::vector<std::thread> own_threads_;
};

}  // namespace welkin::detail
