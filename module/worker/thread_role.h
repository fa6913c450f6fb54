// What threads are to the schedulers whose work they run.
#pragma once

namespace welkin::detail {

class Scheduler;

/// What the calling thread is to a scheduler, for as long as this object lives.
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

  /// Whether the thread is either kind, and so must not wait for the scheduler's work to end.
  [[nodiscard]] static bool has_any(const Scheduler& scheduler) noexcept {
    return is_worker(scheduler) || has(scheduler, bystander);
  }
  /// Whether the scheduler may run computations on it.
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
