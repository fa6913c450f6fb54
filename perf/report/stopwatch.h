// How long a call takes, on a machine that others use too.
#pragma once

#include <functional>

namespace welkin::report {

enum class Clock {
  processor,  ///< time that the calling thread spent on a processor: what others do beside it hardly shows
  wall,
};

/// "processor time", "wall time"
[[nodiscard]] const char* name(Clock clock) noexcept;

/// Runs work again and again, in an arena of its own.
struct Stopwatch {
  int threads = 1;              ///< of that arena
  double budget_seconds = 0.1;  ///< wall time for the repeats of one measurement; the first run is always made
  int most_runs = 1000;

  /// Processor time for one thread, which then does all the work; else wall time.
  [[nodiscard]] Clock clock() const noexcept { return threads == 1 ? Clock::processor : Clock::wall; }

  /// Seconds of a call of `work`: the least of the runs, as whatever else the machine does can only add to it. The
  /// first run fills caches and counts only where the budget allows no other. Calls shorter than 0.2 ms are timed
  /// several at a time. Passes on what `work` throws.
  [[nodiscard]] double seconds(const std::function<void()>& work) const;
};

}  // namespace welkin::report
