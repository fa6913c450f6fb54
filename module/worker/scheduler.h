// A worker's state: which computation waits, runs or is done, and for whom.
//
// Everything is guarded by one mutex. It is held for a few list operations at a time, and never while code of a
// request, a callback or a stop token runs: such work is collected in an `AfterUnlock` and carried out after the mutex
// is unlocked.
//
// The threads of a worker may rank so low that the system keeps them off the processors for seconds, also while they
// hold the mutex. So `post`, `then` and `on_drain` do not wait for it. They put what they bring into an inbox, a list
// without a lock, and try the mutex once. The thread that holds the mutex looks into the inbox when taking it and after
// letting go of it, so that nothing stays there (`LockedState`).
//
// A computation is in one of three kinds of list: that of its parent's followers, one of those that wait, that of those
// that run. It is in none before it is let in and when it is over.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "platform/wait.h"
#include "welkin/worker.h"

namespace welkin::detail {

class ThreadExecutor;

/// Work that a change of the state entails. Jobs that end without a result get their errors before the mutex is
/// unlocked, all else happens after.
struct AfterUnlock {
  ComputationList at_once;                ///< that are to run here
  ComputationList ended;                  ///< that will not start: cancelled, or the worker has ended
  std::shared_ptr<Computation> stopping;  ///< whose results are not needed any more: the first, and `next_to_stop`
  int startable = 0;                      ///< how many have begun to wait for a thread
  int tasks = 0;                          ///< to be handed to the executor
  bool refused = false;                   ///< the executor has just refused a task: no further one is tried at once
  bool news = false;                      ///< for threads that wait
};

using JobsByKey = std::map<JobKey, std::shared_ptr<JobRecord>, std::less<>,
                           JobAllocator<std::pair<const JobKey, std::shared_ptr<JobRecord>>>>;

/// Base of objects that a posting thread makes with `new` and a thread of the worker deletes.
struct InJobMemory {
  // NOLINTNEXTLINE(misc-new-delete-overloads): the delete that takes the size is this one's
  static void* operator new(std::size_t bytes) { return allocate_job_memory(bytes); }
  static void operator delete(void* block, std::size_t bytes) noexcept { free_job_memory(block, bytes); }
};

/// Gives the system back what is kept for later posts.
void give_back_job_memory() noexcept;

/// Returns why a job that is ready has no result, or that there was no memory to say it; null if it has one. Errors are
/// made here, so that cancelling jobs by the hundred makes none that are never read.
[[nodiscard]] std::exception_ptr error_of(const JobRecord& job) noexcept;

/// A posted job, or a computation that follows a job, with the list nodes that it needs later.
struct Submission : InJobMemory {
  Submission(std::shared_ptr<Computation> computation, std::shared_ptr<JobRecord> its_job,
             std::shared_ptr<JobRecord> its_parent);

  std::shared_ptr<JobRecord> job;     ///< may be null for one that follows
  std::shared_ptr<JobRecord> parent;  ///< null for a post
  ComputationList node;
  JobsByKey keyed;             ///< one entry, if the job has a key
  Submission* next = nullptr;  ///< in the inbox
};

class Scheduler : public std::enable_shared_from_this<Scheduler> {
 public:
  using Clock = std::chrono::steady_clock;

  /// Throws `Error` (invalid_argument) for options out of range.
  explicit Scheduler(WorkerOptions options);
  ~Scheduler();
  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

  /// Starts the threads. Throws std::system_error; some may run then, until `terminate`.
  void start();

  // The other half of the public interface.
  void submit(const std::shared_ptr<JobRecord>& job, const PostOptions& options, std::uint64_t bytes,
              ComputationList follower);
  bool cancel(const std::shared_ptr<JobRecord>& job);
  [[nodiscard]] TaskPriority priority_of(const JobRecord& job);
  void set_priority(const JobRecord& job, TaskPriority priority);
  bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
              const std::shared_ptr<JobRecord>& job);
  void wait(const JobRecord& job);
  std::size_t drain(std::chrono::nanoseconds budget);
  void terminate();
  /// Called after `terminate`, when the worker goes. Drops what was not drained, and lets go of threads that cannot be
  /// waited for, as this is one of them. In a fork both do nothing: what is here stays as it is, for ever.
  void abandon_rest();
  void wait_until_idle();
  [[nodiscard]] WorkerLoad load();
  [[nodiscard]] int threads() const noexcept { return threads_; }

  // Called by threads that run computations.
  /// Runs the first of those that wait and have this priority or a higher one; false if there is none. `lent`: as a
  /// task of the executor's.
  bool run_next(bool lent = false, TaskPriority least = TaskPriority::low);

 private:
  using Lock = std::unique_lock<std::mutex>;

  /// The mutex, held. What is in the inbox has been let in. When this goes, the mutex is unlocked, what has been
  /// deferred is carried out, and what came in meanwhile is let in.
  class LockedState {
   public:
    /// Throws `Error` (stopped) in a fork of the worker's process, where the mutex may stay locked for ever.
    explicit LockedState(Scheduler& scheduler) : LockedState(scheduler, scheduler.locked()) {}
    LockedState(Scheduler& scheduler, Lock lock);  ///< `lock` may hold nothing
    ~LockedState();
    LockedState(const LockedState&) = delete;
    LockedState& operator=(const LockedState&) = delete;

    AfterUnlock work;

   private:
    Scheduler& scheduler_;
    Lock lock_;
  };

  /// Returns whether this process is a fork of the one that the worker, and all of its threads, are in.
  [[nodiscard]] bool is_forked() const noexcept;
  /// Throws `Error` (stopped) in one.
  void require_own_process() const;
  [[nodiscard]] Lock locked();

  // Letting jobs in. With the mutex held, but for `put_in_inbox` and `reserve`.
  void put_in_inbox(std::unique_ptr<Submission> submission);
  void empty_inbox(AfterUnlock& work);
  [[nodiscard]] bool inbox_has_something() noexcept;
  [[nodiscard]] std::optional<ErrorCode> reason_to_refuse(const Submission& submission);
  void admit(Submission& submission, AfterUnlock& work);
  void follow(Submission& submission, AfterUnlock& work);
  static void attach(ComputationList& node, const std::shared_ptr<JobRecord>& parent);
  /// Counts a job and bytes against the limits if they hold then, with as much less in flight as will be freed.
  [[nodiscard]] bool reserve(std::uint64_t bytes, std::size_t freed_jobs = 0, std::uint64_t freed_bytes = 0) noexcept;
  void settle(JobRecord& job);

  // Cancelling jobs, and what follows when they are done. With the mutex held, but for `carry_out`.
  bool withdraw(std::shared_ptr<JobRecord> job, ErrorCode reason, AfterUnlock& work);
  static void stop(const std::shared_ptr<Computation>& computation, AfterUnlock& work);
  void dispatch_followers(JobRecord& job, AfterUnlock& work);
  void end(const std::shared_ptr<Computation>& computation, std::exception_ptr error, AfterUnlock& work);
  void tell_jobs_of(AfterUnlock& work);
  void carry_out(AfterUnlock& work);
  [[nodiscard]] static std::uint64_t next_id() noexcept;

  // Starting, running, waiting. With the mutex held: enqueue to startable_for.
  void enqueue(const std::shared_ptr<Computation>& computation, ComputationList& from, bool in_front);
  void let_wait(const std::shared_ptr<Computation>& computation, ComputationList& from, bool in_front,
                AfterUnlock& work);
  void start_running(const std::shared_ptr<Computation>& computation);
  [[nodiscard]] ComputationList take_out(const std::shared_ptr<Computation>& computation);
  [[nodiscard]] std::size_t waiting_count() const noexcept;
  [[nodiscard]] bool is_waiting(const Computation& computation) const noexcept;
  [[nodiscard]] std::shared_ptr<Computation> startable_for(const JobRecord& job) const;
  void run(const std::shared_ptr<Computation>& computation);
  void complete(const std::shared_ptr<Computation>& computation, std::exception_ptr error);

  // Threads.
  void plan_calls(AfterUnlock& work);
  void wake_workers(AfterUnlock& work);
  static void run_task(void* task);
  /// Wakes threads that wait for something that may have come.
  void signal();
  /// Waits until `done()`.
  template <class Done>
  void wait_for(const Done& done);

  WorkerOptions options_;
  std::int64_t process_;                         ///< whose threads run the jobs
  std::shared_ptr<Scheduler> kept_;              ///< this, in a fork: its threads cannot be joined there
  std::unique_ptr<ThreadExecutor> own_threads_;  ///< null with an executor of the engine's
  int threads_ = 0;
  bool callers_may_look_ = false;  ///< keeping their processor, for a job's end

  std::atomic<Submission*> inbox_{nullptr};  ///< the newest first
  std::atomic<std::size_t> jobs_{0};         ///< in flight, those in the inbox too
  std::atomic<std::uint64_t> bytes_{0};

  std::mutex mutex_;
  std::array<ComputationList, 3> waiting_;  ///< by priority
  ComputationList running_;
  ComputationList drained_;                ///< callbacks for the next `drain`
  std::atomic<std::size_t> undrained_{0};  ///< how many these are, readable without the mutex
  JobsByKey newest_;                       ///< job in flight of each key
  int lent_ = 0;                           ///< tasks that the executor has, or runs
  int unstarted_ = 0;                      ///< of these, that it has not called yet
  std::atomic<int> lending_{0};            ///< threads that are inside the executor's `enqueue`
  std::atomic<bool> closed_{false};        ///< terminated: nothing starts any more. Written with the mutex held
  bool abandoned_ = false;                 ///< no thread will drain any more
  bool news_ = false;                      ///< an event that threads wait for: a job is done, or a computation over

  std::atomic<int> signals_{0};  ///< how often there was news. Not a condition variable: `post` signals too, and must
                                 ///< not wait for a mutex that a thread of ours holds
};

template <class Done>
void Scheduler::wait_for(const Done& done) {
  for (;;) {
    const int seen = signals_;
    if (done()) return;
    platform::wait_while(signals_, seen);
  }
}

/// Runs the first of the waiting computations on the calling thread, if there is one of no lower priority than
/// `priority`. A long request calls this between its pieces with its own priority, so that others need not wait for it.
/// Does nothing on threads that no worker owns. Requests may nest in this way to a depth of 8.
void let_another_pass(TaskPriority priority);

}  // namespace welkin::detail
