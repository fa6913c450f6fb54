// Passes that do not wait for each other, at the same time.
#pragma once

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

}  // namespace welkin::jobs
