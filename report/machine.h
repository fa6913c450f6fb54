// Where a report is made.
#pragma once

#include "report/measurement.h"
#include "report/stopwatch.h"

namespace welkin::report {

/// Processor, compiler, instruction set in use, Welkin's version, clock, date, threads.
[[nodiscard]] Machine this_machine(const Stopwatch& stopwatch);

}  // namespace welkin::report
