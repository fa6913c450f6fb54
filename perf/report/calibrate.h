// What work costs on this machine, measured: for the plans of `welkin bake --costs`.
#pragma once

#include "welkin/core.h"
#include "welkin/plan.h"

namespace welkin::report {

/// Measures every member of a `CostModel` here, on one thread, from small pieces of each kind of work, each the fastest
/// of a few runs, by processor time where other programs have taken some of the wall time. What reads files is not
/// measured: it gets the stored number times the mean ratio of the others. Takes some four seconds of processor time.
/// Throws `Error` (cancelled).
[[nodiscard]] CostModel calibrate_costs(const Control& control = {});

}  // namespace welkin::report
