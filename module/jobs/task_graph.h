// Passes that do not wait for each other, at the same time.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "welkin/control.h"

namespace welkin::jobs {

/// One of them: its work, given a control of its own, and its share of the whole (any unit).
struct Pass {
  std::function<void(const Control&)> work;
  double cost = 1.0;
};

/// Runs all passes, in the caller's arena and in any order; the first in the calling thread, so the longest belongs
/// there: whoever has time helps with its tiles, while the caller, once done, can only take passes nobody has begun.
/// The first exception comes out when all passes have ended; those not yet begun are then left out. Progress is that
/// of all by cost. Throws `Error` (cancelled) too.
void run_together(const std::vector<Pass>& passes, const Control& control);

// Passes that run at the same time, but for those that wait for each other.

/// Passes, what each waits for and what it is expected to cost. Made once, run once.
class PassGraph {
 public:
  /// A pass may use TBB, reports its own progress to the control that it gets, and looks at its stop token.
  using Work = std::function<void(const Control&)>;

  /// A pass that begins when all of `after`, passes that were added before, have ended. `cost` > 0 in any unit: orders
  /// passes and weighs progress. Returns the pass's number: 0, 1, 2, ...
  std::size_t add(double cost, Work work, const std::vector<std::size_t>& after = {});

  /// Runs all in the caller's arena. Of passes that could begin, the one with the costliest way to the end goes on in
  /// the thread that found it, the calling thread to begin with; the others are tasks for whoever has time, costliest
  /// first. So the thread that waits at the end has had the longest work, and threads that run out of passes join the
  /// tiles of those that are left.
  ///
  /// Passes run with the default floating-point environment. Progress is one number over all passes. The first
  /// exception stops all passes at their next tile and comes out here when none runs any more; of several, the one of
  /// the pass with the lowest number that was not just told to stop. If the caller's own TBB group is cancelled,
  /// nothing is dropped. A thread that waits in here runs none but these passes. Throws `Error` (cancelled) and what
  /// passes and `control.progress` throw.
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
