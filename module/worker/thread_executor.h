// The threads that run a scheduler's computations: its own, in an arena that nobody else enters, or borrowed ones.
#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "welkin/worker.h"

namespace welkin::detail {

/// Own threads take all slots of an arena as external threads, so that oneTBB sends none of the process's pool there,
/// and the pool stays the engine's. A thread that finds nothing to start parks: it waits in the arena for a task group
/// that whoever has work for it ends. oneTBB has it take part in the parallel work of the others meanwhile, and puts it
/// to sleep if there is none.
class ThreadExecutor {
 public:
  explicit ThreadExecutor(const WorkerOptions& options);
  ~ThreadExecutor();
  ThreadExecutor(const ThreadExecutor&) = delete;
  ThreadExecutor& operator=(const ThreadExecutor&) = delete;

  /// Starts the threads, one of which watches. They keep `scheduler`. Throws std::system_error: then some may run.
  void start(const std::shared_ptr<Scheduler>& scheduler);

  /// Has one more waiting computation started soon; false if no thread of ours is free to.
  bool call_one(const std::shared_ptr<Scheduler>& scheduler);
  /// Has every parked thread look for work.
  void call_all();
  /// One more thread, outside the arena, for one computation. Throws std::system_error, std::bad_alloc.
  void rescue(const std::shared_ptr<Scheduler>& scheduler);
  /// Whether all threads of our own sleep.
  [[nodiscard]] bool all_asleep() const;

  /// Threads leave as soon as they have nothing more to do.
  void dismiss();
  /// Waits until they have left. Not on one of them.
  void join();
  /// Lets go of them.
  void detach();

  /// What a thread is to a scheduler.
  enum class Role {
    worker,     ///< its own, or a borrowed one that runs its work
    bystander,  ///< inside something that its work waits for
  };
  /// Whether the calling thread is either, and so must not wait for the scheduler's work to end.
  [[nodiscard]] static bool serves(const Scheduler& scheduler) noexcept;
  /// Whether it is the scheduler's to run work on.
  [[nodiscard]] static bool runs_for(const Scheduler& scheduler) noexcept;
  [[nodiscard]] bool lent() const noexcept { return static_cast<bool>(lent_arena_); }
  [[nodiscard]] int threads() const noexcept { return threads_; }

  /// Gives the calling thread its role.
  class Service {
   public:
    explicit Service(const Scheduler& scheduler, Role role = Role::worker) noexcept;
    ~Service();
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

   private:
    friend class ThreadExecutor;
    const Scheduler* scheduler_;
    Role role_;
    const Service* outer_;
  };

 private:
  /// Where a thread waits for work.
  struct Parking {
    tbb::task_group group;
    tbb::task_handle blocker;  ///< the group's wait ends when this goes
  };
  struct Rescuer {
    std::thread thread;
    std::atomic<bool> finished{false};
  };

  void serve(Scheduler& scheduler, int number);
  void park(const Scheduler& scheduler);
  void set_up_thread(const char* suffix) const noexcept;

  int threads_;
  ThreadPriority priority_;
  std::string name_;
  std::function<void(std::function<void()>)> lent_arena_;
  std::unique_ptr<tbb::task_arena> arena_;  ///< none with a lent one

  std::mutex mutex_;  ///< guards these two
  std::vector<Parking*> parked_;
  bool dismissed_ = false;

  std::mutex threads_mutex_;  ///< guards these, until nothing is added any more
  std::vector<std::thread> own_threads_;
  std::list<Rescuer> rescuers_;
  bool leaving_ = false;
  std::mutex join_mutex_;

  std::vector<std::atomic<long>> numbers_;  ///< the system's, of those that run computations; 0: not started yet
};

}  // namespace welkin::detail
