// The engine's threads above all others while they are in a frame.
#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include <atomic>

namespace engine_loop {

/// Ranks each thread as SCHED_RR, priority 1, from when it enters an arena until it leaves. Linux gives that to root,
/// to CAP_SYS_NICE, or to whom RLIMIT_RTPRIO allows it.
class RealTime final : public tbb::task_scheduler_observer {
 public:
  explicit RealTime(tbb::task_arena& arena) : tbb::task_scheduler_observer(arena) { observe(true); }
  ~RealTime() override { observe(false); }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  void on_scheduler_entry(bool is_worker) override;
  void on_scheduler_exit(bool is_worker) override;

  /// Whether the system said no.
  [[nodiscard]] bool refused() const noexcept { return refused_; }

 private:
  std::atomic<bool> refused_{false};
};

}  // namespace engine_loop
