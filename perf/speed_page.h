// The page of figures that Welkin is held to: each beside the machine's own limit and the mark it is to reach.
#pragma once

#include <string>
#include <vector>

namespace welkin::perf {

/// Runs the benchmarks that the page shows (they are registered, and Google Benchmark is initialised) and returns the
/// page as Markdown. Of repetitions the fastest counts. Names of running benchmarks go to standard error.
[[nodiscard]] std::string speed_page();

}  // namespace welkin::perf
