// Passes that run at the same time, but for those that wait for each other.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "welkin/core.h"

namespace welkin::jobs {

/// Passes, what each waits for and what it is expected to cost. Made once, run once.
class TaskGraph {
 public:
  /// A pass may run tiles, graphs and anything else of TBB. It reports its own progress to the control that it gets,
  /// and looks at that control's stop token.
  using Work = std::function<void(const Control&)>;

  /// A pass that begins when all of `after`, passes that were added before, have ended. `cost` > 0 in any unit: orders
  /// passes and weighs progress. Returns the pass's number: 0, 1, 2, ...
  std::size_t add(double cost, Work work, const std::vector<std::size_t>& after = {});

  /// Runs all in the caller's arena. Of passes that can begin, the one with the costliest way to the end continues in
  /// the thread that found it, at first the calling thread; the others become tasks for any free thread, costliest
  /// first. So the thread that waits at the end has had the longest work, and threads that run out of passes join the
  /// tiles of the remaining ones.
  ///
  /// Passes run with the default floating-point environment. Progress is one number over all passes. The first
  /// exception stops all passes at their next tile and comes out here when none runs any more; of several, that of
  /// the pass with the lowest number that was not merely stopped. Nothing is dropped if the caller's own TBB group is
  /// cancelled. A thread that waits in here runs only these passes; next to a `OneThread` it runs all of them, in
  /// order. Throws `Error` (cancelled) and what passes and `control.progress` throw.
  void run(const Control& control);

  /// Wall time of a pass that has run.
  [[nodiscard]] double milliseconds(std::size_t pass) const { return passes_[pass].milliseconds; }

 private:
  class Run;

  struct Pass {
    double cost;
    Work work;
    std::size_t waits_for;          ///< how many
    std::vector<std::size_t> next;  ///< which wait for it
    double way = 0.0;               ///< cost of the costliest way from here to the end
    double milliseconds = 0.0;
  };

  std::vector<Pass> passes_;
};

}  // namespace welkin::jobs
