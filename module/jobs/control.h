// How a call uses its `Control`: it checks for cancellation and reports progress.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "welkin/core.h"

namespace welkin::jobs {

/// The words of the error that a cancelled call ends with.
inline constexpr const char* kCancelled = "cancelled by the caller";

/// Throws `Error` (cancelled) once stop is requested. No other function throws that error for a caller's stop token.
void throw_if_cancelled(const stop_token& stop);
inline void throw_if_cancelled(const Control& control) { throw_if_cancelled(control.stop); }

/// The part [from, to] of a call's progress, its stop token and its memory. `control` must outlive what is returned.
[[nodiscard]] Control part_of(const Control& control, double from, double to);

/// Adds up the units of work that several threads have done and reports their fraction of the total to the caller:
/// one call at a time, never decreasing, 1 in the last call.
///
/// The counts are relaxed on x86. oneTBB orders every task before the join, and the lock orders the callbacks (a thread
/// that fails to get it has counted before: no later instruction overtakes that addition there). An order between
/// tasks, made here, would hide races from the thread sanitizer if the tasks do not overlap in time. ARM needs that
/// order: the addition and the check after unlocking are both ordered among the count's changes, so either the check
/// sees the addition or the adding thread sees the lock free.
class Progress {
 public:
  /// `control` must outlive this. `whole` is the number of units that will be added in all.
  Progress(const Control& control, std::uint64_t whole) : control_(control), whole_(whole) {}

  [[nodiscard]] bool wanted() const { return static_cast<bool>(control_.progress); }
  [[nodiscard]] std::uint64_t done() const { return done_.load(std::memory_order_relaxed); }

  /// Throws what the caller's callback throws.
  void add(std::uint64_t units);

 private:
  [[nodiscard]] bool is_behind() noexcept;

  const Control& control_;
  std::uint64_t whole_;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::uint64_t> reported_{0};
  std::mutex mutex_;
};

}  // namespace welkin::jobs
