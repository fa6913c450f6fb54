// How a caller steers a long call: cancellation, progress, threads.
#pragma once

#include <functional>
#include <stop_token>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// Passed to every call that can take longer than a frame. The default asks for nothing.
struct Control {
  /// Checked before every tile: 0.05 to 0.6 ms of work on pixels in memory, one block of rows or tiles of a file
  /// (docs/threading.md has what was measured). Once stop is requested the call throws `Error` with
  /// `ErrorCode::cancelled`; nothing that the call would have returned exists.
  std::stop_token stop{};

  /// Called with the share of the work that is done, in [0, 1], never falling, the last call being 1.
  /// It comes from whichever thread finished a tile, one call at a time, with the default floating-point
  /// environment, and may use TBB itself; what it throws ends the call and reaches the caller. Left empty, progress
  /// costs nothing.
  std::function<void(double)> progress{};
};

/// How the system ranks a worker's threads against all others.
enum class ThreadPriority {
  idle,    ///< runs only on processors that nothing else wants (Linux SCHED_IDLE)
  below,   ///< a tenth of a normal thread's share when both want a processor (nice + 10)
  normal,  ///< as the thread that made the worker
};

/// Runs `work` in an arena of its own with `threads` threads (0: as many as the process may use).
///
/// Every Welkin call works in the arena of the thread that calls it, so an engine that lives in a TBB
/// arena keeps its thread budget without this function. It is for programs that have no arena.
/// The number of threads never changes a result's bits.
/// Throws `Error` (invalid_argument) unless 0 <= threads <= 1024, and whatever `work` throws.
void run_with_threads(int threads, const std::function<void()>& work);

/// How many threads `run_with_threads(0, ...)` uses: the processors of this process, or fewer where
/// the control group's CPU quota (cgroup v2 `cpu.max`) grants fewer. At least 1.
[[nodiscard]] int available_threads();

}  // namespace welkin
