// A worker's books: which computation waits, runs or is done, and for whom.
//
// Everything is guarded by one mutex, which is held for a few list operations at a time and never while code of a
// request, a callback, a promise or a stop token runs (but for requests' operator==): what is to be done outside is
// collected in a `DeferredWork` and carried out after the mutex is unlocked.
//
// A computation is in one of three kinds of list: that of its parent's continuation, one of those that wait, that of
// those that run. It is in none before it is let in and when it is over.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

#include "welkin/worker.h"

namespace welkin::detail {

class ThreadExecutor;

/// Work that a change of the books defers until the mutex is unlocked.
struct DeferredWork {
  JobList losers;                         ///< whose futures get the error that `withdrawn` says
  ComputationList discarded;              ///< whose memory is to come back
  std::shared_ptr<Computation> stopping;  ///< that runs for nobody any more
};

/// What was attached to jobs and has lost its worker, because that has ended: for `abandon`.
struct Orphans {
  ComputationList continuations;  ///< that cannot start any more
  DeliveryList deliveries;        ///< that nobody will drain
};

/// A job that is being posted, with the list nodes it needs once it is admitted.
struct PendingPost {
  explicit PendingPost(std::shared_ptr<JobRecord> asking)
      : job(std::move(asking)), job_node{job}, node{job->computation} {
    job->place = job_node.begin();
    if (job->computation->shareable()) entry.emplace(job->computation->hash(), job->computation);
  }

  std::shared_ptr<JobRecord> job;
  JobList job_node;
  ComputationList node;
  ComputationIndex entry;  ///< one, if it can be shared
};

class Scheduler : public std::enable_shared_from_this<Scheduler> {
 public:
  /// Throws `Error` (invalid_argument) for options out of range.
  explicit Scheduler(WorkerOptions options);
  ~Scheduler();
  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

  /// Starts the threads. Throws std::system_error; some may run then, until `terminate`.
  void start();

  // The other half of the public interface.
  void submit(const std::shared_ptr<JobRecord>& job, const PostOptions& options, std::uint64_t bytes);
  bool cancel(const std::shared_ptr<JobRecord>& job);
  [[nodiscard]] Priority priority_of(const JobRecord& job) const;
  void set_priority(JobRecord& job, Priority priority);
  bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
              const std::shared_ptr<JobRecord>& job);
  bool attach(JobRecord& parent, DeliveryList delivery);
  void help(const JobRecord& job);
  std::size_t drain(std::chrono::nanoseconds budget);
  void terminate();
  /// After `terminate`, when the worker goes: drops what was not drained, and lets go of threads that cannot be waited
  /// for because this is one of them.
  void abandon_rest();
  void wait_until_idle();
  [[nodiscard]] WorkerLoad load() const;
  [[nodiscard]] int threads() const noexcept;

  // What the executor's threads do.
  /// Runs the first of those that wait; false if there is none.
  bool run_next();
  [[nodiscard]] bool has_waiting() const;
  /// On the watching thread: looks, while computations wait, whether all threads that could start one sleep, and has it
  /// rescued. Returns when the worker ends.
  void watch();

 private:
  using Lock = std::unique_lock<std::mutex>;

  // Admitting jobs (scheduler.cpp). With the mutex held, but for that of `submit`.
  enum class Admission { admitted, refused, wait };
  [[nodiscard]] Admission decide(PendingPost& pending, DeferredWork& deferred);
  void admit(PendingPost& pending, const std::shared_ptr<Computation>& equal, const std::shared_ptr<JobRecord>& older,
             DeferredWork& deferred);
  [[nodiscard]] std::shared_ptr<Computation> find_equal(const PendingPost& pending) const;
  [[nodiscard]] bool fits(std::size_t freed_jobs, std::uint64_t bytes, std::uint64_t freed_bytes) const noexcept;
  [[nodiscard]] bool make_room(const JobRecord& job, std::size_t freed_jobs, std::uint64_t bytes,
                               std::uint64_t freed_bytes, const std::array<const Computation*, 2>& spared,
                               DeferredWork& deferred);
  void count_out(JobRecord& job);
  void forget(const JobRecord& job);
  /// No more jobs join it.
  void close(Computation& computation);

  // Giving jobs up, and what follows when they are done (settling.cpp).
  bool withdraw(std::shared_ptr<JobRecord> job, ErrorCode reason, DeferredWork& deferred);
  void withdraw_all(const std::shared_ptr<Computation>& computation, ErrorCode reason, DeferredWork& deferred);
  void settle(JobRecord& job);
  void carry_out(DeferredWork deferred);
  void fail(JobRecord& job, ErrorCode reason, Orphans& orphans);
  /// Hands on what was attached to a job that is done.
  void pass_on(JobRecord& job, Orphans& orphans);
  void abandon(Orphans orphans);
  ComputationList fail_orphans(Orphans& orphans);
  static void let_go(const ComputationList& ended, const DeliveryList& late);
  void stop_running();
  [[nodiscard]] static std::uint64_t next_id() noexcept;

  // Starting and running (running.cpp). With the mutex held: enqueue to update_priority.
  void enqueue(const std::shared_ptr<Computation>& computation, ComputationList& from, bool in_front);
  void start_running(const std::shared_ptr<Computation>& computation);
  [[nodiscard]] ComputationList taken_out(const std::shared_ptr<Computation>& computation);
  [[nodiscard]] bool any_waiting() const noexcept;
  [[nodiscard]] bool is_waiting(const Computation& computation) const noexcept;
  [[nodiscard]] ComputationList& waiting(Priority priority) noexcept;
  void update_priority(const std::shared_ptr<Computation>& computation);
  void rank(const std::shared_ptr<Computation>& computation, Priority priority);
  void call_for_hands();
  void run(const std::shared_ptr<Computation>& computation);
  void complete(const std::shared_ptr<Computation>& computation, std::exception_ptr error);

  /// Whether no thread of this scheduler's runs or is about to (scheduler.cpp). Without the mutex.
  [[nodiscard]] bool nobody_moves() const;

  WorkerOptions options_;
  std::unique_ptr<ThreadExecutor> executor_;

  mutable std::mutex mutex_;
  std::condition_variable room_;            ///< for those who wait in `submit`
  std::condition_variable idle_;            ///< for those who wait for the end of what runs
  std::condition_variable watch_;           ///< for the watching thread
  std::array<ComputationList, 3> waiting_;  ///< by priority
  ComputationList running_;
  DeliveryList drained_;                   ///< callbacks for the next `drain`
  std::atomic<std::size_t> undrained_{0};  ///< how many these are, for who does not hold the mutex
  std::unordered_map<std::string, std::shared_ptr<JobRecord>> newest_;  ///< job in flight of each key
  ComputationIndex shareable_;                                          ///< in flight, by hash
  std::size_t jobs_ = 0;                                                ///< that count against the limit
  std::uint64_t bytes_ = 0;
  std::uint64_t events_ = 0;  ///< computations started or ended: whether anything moves
  std::size_t calling_ = 0;   ///< threads that ask a lent arena for hands
  std::size_t ending_ = 0;    ///< threads in `terminate` that are giving jobs their errors
  bool watching_ = false;     ///< the watching thread looks by itself for now
  bool closed_ = false;       ///< terminated: nothing starts any more
  bool abandoned_ = false;    ///< nobody will drain any more
};

}  // namespace welkin::detail
